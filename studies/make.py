"""Make studies by name, such as `worth` or `section4/fig08`, or all of them: `make studies`."""

import itertools
import signal
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent


def scripts() -> list[str]:
    """Return the files that make, judge and draw something, as FOLDER/NAME."""
    return _files_with("\n    main(script)\n")


def others() -> list[str]:
    """Return the scripts with options of their own, which only their pages' commands run."""
    return sorted({*_files_with('\nif __name__ == "__main__":\n')} - {*scripts()})


def _files_with(text: str) -> list[str]:
    return [
        f"{path.parent.name}/{path.stem}"
        for path in sorted(HERE.glob("*/*.py"))
        if text in path.read_text(encoding="utf-8")
    ]


def _finished(command: list[str]) -> int:
    # On Ctrl-C, which the script receives too, `subprocess.run` would kill it before it has
    # written the runs that were made. SIGTERM comes here alone, and is passed on.
    with subprocess.Popen(command, cwd=HERE.parent) as process:

        def stop(*_: object) -> None:
            process.terminate()
            raise KeyboardInterrupt

        before = signal.signal(signal.SIGTERM, stop)
        try:
            return process.wait()
        except KeyboardInterrupt:
            process.wait()
            raise
        finally:
            signal.signal(signal.SIGTERM, before)


def main(arguments: list[str] | None = None) -> None:
    """Run each file in a process of its own: names first, then the options of every file."""
    given = sys.argv[1:] if arguments is None else arguments
    names = list(itertools.takewhile(lambda text: not text.startswith("-"), given))
    options, made, left = given[len(names) :], scripts(), others()

    def named(files: list[str]) -> list[str]:
        return [each for each in files if not names or {each, each.partition("/")[0]} & {*names}]

    known = {*made, *left, *(each.partition("/")[0] for each in [*made, *left])}
    if unknown := [name for name in names if name not in known]:
        sys.exit(f"Error: {unknown[0]!r} is not a study of this folder: {', '.join(sorted(known))}")
    failed = []
    for each in named(made):
        module = f"{HERE.name}.{each.replace('/', '.')}"
        command = [sys.executable, "-m", module, *options]
        if _finished(command):
            failed.append(each)
    if left := named(left):
        print(f"Run by the commands on their pages, not here: {', '.join(left)}")
    if failed:
        sys.exit(f"{', '.join(failed)} did not end well; the same command resumes from there")


if __name__ == "__main__":
    main()
