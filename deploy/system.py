"""Are the system's libraries there? Installs them where it may, or names the command that does.

Run by `make setup`; standard library only. Off-screen rendering needs EGL and Mesa's software
driver; the tests of the page need Chromium (`--browser`).
"""

import ctypes.util
import os
import shutil
import subprocess
import sys

RENDERING = ("libegl1", "libegl-mesa0", "libgl1-mesa-dri")
BROWSERS = ("chromium-headless-shell", "chromium")  # The first is faster, and here the same.


def missing(browser: bool) -> list[str]:
    """Debian packages that are needed and not there."""
    packages: list[str] = []
    mesa = ctypes.util.find_library("EGL_mesa") or has_vendor_driver()
    if not (ctypes.util.find_library("EGL") and mesa):
        packages += RENDERING
    if browser and not find_browser():
        packages += BROWSERS[:1]
    return packages


def find_browser() -> str | None:
    """Where the tests' browser is; None: nowhere."""
    return next(filter(None, map(shutil.which, BROWSERS)), None)


def has_vendor_driver() -> bool:
    """A graphics card's own EGL driver does as well as Mesa."""
    return any(os.path.isdir(d) and os.listdir(d) for d in ("/usr/share/glvnd/egl_vendor.d",))


def main() -> None:
    packages = missing("--browser" in sys.argv)
    if not packages:
        return
    command = ["apt-get", "install", "-y", "--no-install-recommends", *packages]
    if shutil.which("apt-get") is None or os.geteuid() != 0:
        sys.exit(
            f"hl-dagger needs {', '.join(packages)} (Debian's names).\n"
            f"Install them with:  sudo {' '.join(command)}\nthen run make again."
        )
    print(f"installing {', '.join(packages)} …")
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    quiet = {"check": True, "stdout": subprocess.DEVNULL, "env": environment}
    subprocess.run(["apt-get", "update"], **quiet)  # type: ignore[call-overload]
    subprocess.run(command, **quiet)  # type: ignore[call-overload]


if __name__ == "__main__":
    main()
