"""Make studies by name, such as `worth` or `section4/fig08`, or all of them: `make studies`."""

import itertools
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent


def scripts() -> list[str]:
    """Return the files that make, judge and draw something, as FOLDER/NAME."""
    files = sorted(HERE.glob("*/*.py"))
    return [
        f"{path.parent.name}/{path.stem}"
        for path in files
        if "\n    main(script)\n" in path.read_text(encoding="utf-8")
    ]


def main(arguments: list[str] | None = None) -> None:
    """Run each file in a process of its own: names first, then the options of every file."""
    given = sys.argv[1:] if arguments is None else arguments
    names = list(itertools.takewhile(lambda text: not text.startswith("-"), given))
    options, every = given[len(names) :], scripts()
    chosen = [each for each in every if not names or {each, each.partition("/")[0]} & {*names}]
    known = {*every, *(each.partition("/")[0] for each in every)}
    if unknown := [name for name in names if name not in known]:
        sys.exit(f"Error: {unknown[0]!r} is no study of this folder: {', '.join(sorted(known))}")
    failed = []
    for each in chosen:
        module = f"{HERE.name}.{each.replace('/', '.')}"
        command = [sys.executable, "-m", module, *options]
        if subprocess.run(command, cwd=HERE.parent, check=False).returncode:
            failed.append(each)
    if failed:
        sys.exit(f"{', '.join(failed)} did not end well; the same command resumes from there")


if __name__ == "__main__":
    main()
