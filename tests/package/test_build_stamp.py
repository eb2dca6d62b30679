"""Law: `make build` builds again where another install took the place of this folder's own, and
where what was compiled is gone or for another processor."""

import shutil
import subprocess
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
pytestmark = pytest.mark.skipif(shutil.which("make") is None, reason="needs make")


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """A folder in which everything is built, as far as make can see."""
    for name in ("Makefile", "pyproject.toml", "requirements.lock"):
        shutil.copy(REPOSITORY / name, tmp_path)
    for name in ("Cargo.toml", "Cargo.lock", "src/lib.rs", "flockenv/_core.abi3.so"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    packages = tmp_path / ".venv" / "lib" / "python3.11" / "site-packages"
    packages.mkdir(parents=True)
    (packages / "flockenv.pth").write_text(str(tmp_path))
    stamps = tmp_path / ".venv" / ".stamps"
    stamps.mkdir()
    for name in ("venv", "compare", "core", "core-avx2"):
        (stamps / name).touch()
    return tmp_path


def builds(clone: Path, *variables: str) -> bool:
    """Whether `make build` would build."""
    command = ["make", "--dry-run", "build", *variables]
    reported = subprocess.run(command, cwd=clone, capture_output=True, text=True, check=True)
    return "maturin develop" in reported.stdout


def test_what_is_built_stays(clone: Path) -> None:
    assert not builds(clone)


@pytest.mark.parametrize(
    ("built", "codegen"), [("core-avx2", ""), ("core", "-- -C target-feature=+avx2")]
)
def test_for_another_processor_it_is_built_again(clone: Path, built: str, codegen: str) -> None:
    for stamp in (clone / ".venv" / ".stamps").glob("core*"):
        if stamp.name != built:
            stamp.unlink()
    assert builds(clone, f"CODEGEN={codegen}")
    other = "" if codegen else "-- -C target-feature=+avx2"
    assert not builds(clone, f"CODEGEN={other}")


def test_what_was_removed_is_built_again(clone: Path) -> None:
    (clone / "flockenv" / "_core.abi3.so").unlink()
    assert builds(clone)


def test_another_install_is_replaced(clone: Path, tmp_path: Path) -> None:
    """Of another folder, and one that is not editable."""
    (path,) = clone.rglob("flockenv.pth")
    path.write_text(str(tmp_path / "another" / "flockenv"))
    assert builds(clone)
    path.unlink()
    (path.parent / "flockenv").mkdir()
    assert builds(clone)
