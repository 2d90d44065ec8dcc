# SPDX-License-Identifier: BSD-3-Clause
"""Runs in ParaView's window: from its next start on it loads both plugins by itself, or no more.

Sample run; examples/register does it:
    PALPATE_PLUGINS=build/lib/paraview-5.11/plugins PALPATE_REGISTER=on \\
        paraview --script=register.py
"""
import ctypes
import os
import traceback

from paraview import servermanager

NAMES = ("Palpate", "PalpateInteractor")


def register(folder, loads):
    manager = servermanager.vtkSMProxyManager.GetProxyManager().GetPluginManager()
    known = manager.GetLocalInformation()
    for name in NAMES:
        path = os.path.join(folder, name, name + ".so")
        if loads and not manager.LoadLocalPlugin(path):
            raise RuntimeError(f"{path} cannot be loaded")
    for i in range(known.GetNumberOfPlugins()):
        if known.GetPluginName(i) in NAMES:
            # ParaView writes the list when it ends.
            known.SetAutoLoadAndForce(i, loads)


try:
    register(os.environ["PALPATE_PLUGINS"], os.environ["PALPATE_REGISTER"] == "on")
    print("palpate: done", flush=True)
except Exception:
    traceback.print_exc()
# As File > Exit does, so that it writes what it knows. Its Python has no Qt.
ctypes.CDLL(None)._ZN16QCoreApplication4quitEv()
