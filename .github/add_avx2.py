"""Put the core compiled for AVX2 into the wheel beside the other: `flockenv/_avx2.py` chooses.

dist holds the wheel and dist/avx2 the one that was compiled for AVX2, which is removed.
"""

import base64
import csv
import hashlib
import io
import shutil
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

DIST = Path("dist")


def main() -> None:
    """Write the wheel again, with one file and the line for it in RECORD more."""
    (wheel,), (other,) = DIST.glob("*.whl"), (DIST / "avx2").glob("*.whl")
    with ZipFile(wheel) as opened:
        files = {each: opened.read(each) for each in opened.infolist()}
    (core,) = (each for each in files if Path(each.filename).match("flockenv/_core.*[od]"))
    (record,) = (each for each in files if each.filename.endswith(".dist-info/RECORD"))
    added = ZipInfo(core.filename.replace("_core", "_core_avx2", 1), core.date_time)
    added.external_attr = core.external_attr
    with ZipFile(other) as opened:
        files[added] = opened.read(core.filename)
    digest = base64.urlsafe_b64encode(hashlib.sha256(files[added]).digest()).rstrip(b"=").decode()
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(
        [added.filename, f"sha256={digest}", len(files[added])]
    )
    files[record] = line.getvalue().encode() + files[record]
    with ZipFile(wheel, "w", ZIP_DEFLATED) as opened:
        for each, content in files.items():
            opened.writestr(each, content, ZIP_DEFLATED)
    shutil.rmtree(DIST / "avx2")


main()
