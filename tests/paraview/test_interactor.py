# SPDX-License-Identifier: BSD-3-Clause
"""The dock Palpate in ParaView's window: touched with a simulated hand and with the mouse, the body
is seen deformed and the loop keeps its pace; started and stopped twenty times; left by what it
needs, it ends. Touched on a server, too.

  test_interactor.py <palpate_test_make_space> <folder of the plugin PalpateInteractor> <server>…

where <server> is the command that starts pvserver.
"""

import contextlib
import os
import shutil
import socket
import subprocess
import sys

from image_support import share_different, share_drawn
from support import SKIPPED

HERE = os.path.dirname(os.path.abspath(__file__))
TIME_OUT = 180  # s
HOST = "127.0.0.1"  # A bare system knows no name for it.


def free_port():
    with socket.socket() as held:
        held.bind((HOST, 0))
        return held.getsockname()[1]


def wait_for(line, process):
    """Until the process prints it."""
    for printed in process.stdout:
        print(printed, end="", flush=True)
        if line in printed:
            return
    raise AssertionError(f"no line with {line}")


def with_children(process):
    """Its id, and those of all processes that it has started."""
    found = [process]
    for one in found:
        with open(f"/proc/{one}/task/{one}/children", encoding="ascii") as children:
            found += map(int, children.read().split())
    return found


@contextlib.contextmanager
def served(server):
    """The port of a server that runs, and its processes."""
    port = free_port()
    # This process is an MPI program of its own, and mpiexec would take over what it is told of it.
    environment = {name: value for name, value in os.environ.items()
                   if "-n" not in server or not name.startswith(("OMPI_", "PMIX_"))}
    with subprocess.Popen([*server, f"--server-port={port}"], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, env=environment) as running:
        try:
            wait_for("Accepting connection", running)
            yield port, with_children(running.pid)
            running.wait(timeout=TIME_OUT)
        finally:
            running.terminate()


def run(what, folder, server=(0, ()), script="interactor_script.py", loses_server=False,
        refusal=None, **environment):
    """What the window has printed, by its first word.
    refusal: The words of the one error that is expected.
    loses_server: ParaView tells what it has lost, and its return code is not 0; before, the loop
    has ended."""
    port, processes = server
    environment = dict(os.environ, PALPATE_INTERACTOR_RUN=what, PALPATE_INTERACTOR_PORT=str(port),
                       PALPATE_INTERACTOR_SERVER=" ".join(map(str, processes)), **environment)
    environment["PV_PLUGIN_PATH"] += os.pathsep + folder
    command = ["paraview", "--disable-registry", "--script",
               os.path.join(HERE, script)]
    run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                         errors="replace", timeout=TIME_OUT, check=False, env=environment)
    print(run.stdout, flush=True)
    if loses_server:
        assert run.returncode >= 0, run.returncode
        assert "the tool is without force" in run.stdout and "not lost" not in run.stdout
    else:
        assert run.returncode == 0, (what, run.returncode)
    lines = run.stdout.splitlines()
    assert not any("Traceback" in line for line in lines), what
    errors = [line for line in lines if "ERR|" in line]
    assert loses_server or len(errors) == (1 if refusal else 0), (what, errors)
    assert refusal is None or refusal in errors[0], (what, errors)
    figures = {}
    for line in lines:
        name, *values = line.split() or [""]
        try:
            figures[name] = [float(value) for value in values]
        except ValueError:
            pass  # none of ours
    return figures


def main():
    make_space, folder, *server = sys.argv[1:]
    if shutil.which("paraview") is None:
        sys.exit(SKIPPED)
    subprocess.run([make_space, "block.palpate"], check=True, stdout=subprocess.DEVNULL)

    alone = run("touching,mouse,escape,busy,ends", folder)
    torn = run("tears", folder)["torn"]
    assert 0 < torn[0] <= 24 and torn[3] > 0.01, torn
    assert share_different("torn.png", "let_go.png") > 0.01
    area, force, *_ = run("blade", folder)["bladed"]
    # 30 J/m² along a front of 60 mm, which the body that is held open helps, and 0.2 N of friction.
    assert area > 1 and 1.7 < force < 2, (area, force)
    assert share_different("blade.png", "cut_open.png") > 0.01
    cut = run("cuts,cuts_pressed", folder, refusal="severs the body")
    assert 0.02 < cut["forces"][1] < 0.97 * cut["forces"][0], cut
    assert 0.1 < alone["force"][0] < 10, alone
    # Whether the view follows and no tick is lost tells only a machine on which the threads hardly
    # wait for a processor. On any other a frame still takes no more of the thread that draws it
    # than twice what 65 ms are, the most that was seen with thirty other threads on two processors.
    cost, waited, frames = alone["frame"]
    is_quiet = waited < 0.05
    assert frames > 20 if is_quiet else cost < 0.13, alone
    assert alone["rate"][0] > (990 if is_quiet else 500), alone
    assert alone["ticks"][1] > 500, alone
    assert share_different("rest.png", "touched.png") > 0.01
    assert share_different("rest.png", "rest_again.png") == 0
    # The figures were shown before the end.
    assert alone["recorded"][0] >= alone["ticks"][1], alone
    assert share_drawn("graph.png") > 0.01

    assert alone["dragged"][0] > 0.002, alone
    assert share_different("rest.png", "dragged.png") > 0.01
    assert share_different("left.png", "started.png") > 0.01
    assert alone["escaped"] == [1], alone
    # The key is pressed one second after the work has begun, which takes four.
    assert alone["busy"][0] < 2500, alone
    assert alone["ended"] == [1] and alone["threads"][0] <= 0, alone

    # Both of Mesa's, of which one does not draw points as spheres.
    for driver in ("llvmpipe", "softpipe"):
        dots = run("dots", folder, LIBGL_ALWAYS_SOFTWARE="1", GALLIUM_DRIVER=driver)
        for size in ("dot_1000", "dot_1270"):
            black, white = dots[size]
            assert 10 < black < 200 and 15 < white < 200, (driver, size, dots)

    for what in ("quit", "close"):
        assert run(what, folder)["left"] == [1], what

    with served(server) as running:
        remote = run("remote", folder, running)
    assert remote["ended"] == [1], remote
    assert remote["ranks"] == [server.count("-n") + 1], remote
    with served(server) as running:
        run("lost", folder, running, loses_server=True)


if __name__ == "__main__":
    main()
