"""The page: its vendored files are what they are said to be, and nothing comes from elsewhere."""

import hashlib
import re
from importlib.resources import files
from pathlib import Path

PAGE = Path(str(files("services.correction_api.page")))
ROW = re.compile(
    r"^\| (\S+\.(?:js|css)) \| \S+ \S+ \| \S+ \| \S+ \| ([0-9a-f]{64}) \|$", re.MULTILINE
)


def test_vendored_files_have_their_hash_and_licence() -> None:
    vendor = PAGE / "vendor"
    rows = dict(ROW.findall((vendor / "README.md").read_text()))
    assert set(rows) == {path.name for path in vendor.iterdir() if path.suffix in (".js", ".css")}
    for name, sha256 in rows.items():
        assert hashlib.sha256((vendor / name).read_bytes()).hexdigest() == sha256
        assert (vendor / name).with_suffix(".LICENSE.txt").exists()


def test_the_page_names_no_address_of_anybody_else() -> None:
    for path in PAGE.glob("*.*"):
        if path.suffix in (".html", ".js", ".css"):
            assert not re.search(r"https?://|//[a-z]+\.[a-z]", path.read_text()), path.name


def test_the_page_works_below_any_path() -> None:
    for path in PAGE.glob("*.html"):
        assert not re.search(r"""(?:href|src)=["']/""", path.read_text()), path.name
