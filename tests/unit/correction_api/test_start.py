"""The API starts without torch and without MuJoCo."""

import subprocess
import sys

SCRIPT = """
import sys
import services.correction_api.__main__, services.oracle.__main__
import shared.wire.session
heavy = {"torch", "mujoco", "gymnasium"} & set(sys.modules)
sys.exit(f"imported {heavy}" if heavy else 0)
"""


def test_nothing_heavy_is_imported() -> None:
    done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_a_wrong_setting_ends_with_code_2_and_names_the_right_one() -> None:
    command = [sys.executable, "-m", "services.correction_api", "--set", "prot=1"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 2
    assert "unknown key 'prot'" in done.stderr
    assert "nearest known: 'port'" in done.stderr
