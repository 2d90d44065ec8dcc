# SPDX-License-Identifier: BSD-3-Clause
"""A person's ParaView has both plugins from its next start on, and no more when that is taken back:
examples/register.

  test_register.py <folder of both plugins>
"""

import os
import shutil
import subprocess
import sys

from support import SKIPPED

SOURCE = os.environ["PALPATE_SOURCE_DIR"]
HERE = os.path.dirname(os.path.abspath(__file__))
TIME_OUT = 180  # s


def run(script, **environment):
    """What ParaView's window prints, for a person with settings of its own in the folder home."""
    environment = dict(os.environ, HOME=os.path.abspath("home"), **environment)
    for name in ("PV_PLUGIN_PATH", "XDG_CONFIG_HOME"):
        environment.pop(name, None)
    run = subprocess.run(["paraview", "--script", script], stdout=subprocess.PIPE,
                         stderr=subprocess.STDOUT, text=True, timeout=TIME_OUT, check=False,
                         env=environment)
    print(run.stdout, flush=True)
    assert run.returncode == 0, run.returncode
    return run.stdout


def register(state, folder):
    script = os.path.join(SOURCE, "examples", "common", "register.py")
    assert "palpate: done" in run(script, PALPATE_PLUGINS=folder, PALPATE_REGISTER=state)


def found():
    said = run(os.path.join(HERE, "register_script.py"))
    return "dock 1" in said, "filter 1" in said


def main():
    folder = os.path.abspath(sys.argv[1])
    if shutil.which("paraview") is None:
        sys.exit(SKIPPED)
    shutil.rmtree("home", ignore_errors=True)
    os.mkdir("home")
    register("on", folder)
    assert found() == (True, True)
    register("off", folder)
    assert found() == (False, False)


if __name__ == "__main__":
    main()
