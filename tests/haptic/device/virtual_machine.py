# SPDX-License-Identifier: BSD-3-Clause
"""A virtual machine with a stock Debian kernel whose /init is a program of ours.

QEMU counts instructions instead of looking at the host's clock (-icount, 4 ns each), and skips the
time in which the guest sleeps: what the guest sees, its times included, is the same in each run,
however busy the host is.
"""

import lzma
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

QEMU = "qemu-system-x86_64"
# The first is the smaller one; that of Debian unstable knows no HID.
KERNELS = ["linux-image-cloud-amd64", "linux-image-amd64"]
MODULES = ["hid", "hid-generic", "uhid"]  # as they need each other


class Unavailable(Exception):
    """Something is missing here that is none of the project's."""


def fetch_kernel(folder):
    """Puts vmlinuz and modules into the folder; downloads and unpacks, and installs nothing."""
    if all((folder / name).is_file() for name in ["vmlinuz", *(f"{m}.ko" for m in MODULES)]):
        return
    for tool in [QEMU, "apt-cache", "apt-get", "dpkg-deb"]:
        if shutil.which(tool) is None:
            raise Unavailable(f"there is no {tool}")
    folder.mkdir(parents=True, exist_ok=True)
    for kernel in KERNELS:
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            unpack(kernel, scratch)
            found = [module for name in MODULES
                     for module in Path(scratch).glob(f"**/kernel/drivers/hid/{name}.ko*")]
            if len(found) == len(MODULES):
                for name, module in zip(MODULES, found):
                    packed = module.suffix == ".xz"  # as they are from Debian 13 on
                    (folder / f"{name}.ko").write_bytes(
                        lzma.decompress(module.read_bytes()) if packed else module.read_bytes())
                image, = (path for path in Path(scratch).glob("**/vmlinuz*") if path.is_file())
                image.rename(folder / "vmlinuz")
                return
    raise Unavailable(f"none of {', '.join(KERNELS)} has the modules {', '.join(MODULES)}")


def unpack(kernel, folder):
    # The package of that name is empty: it depends on the one of the newest version, which in
    # Debian unstable is empty as well.
    package = re.search(r"Depends: (linux-image-\S+)", call("apt-cache", "depends", kernel))
    if package is None:
        raise Unavailable(f"apt knows no kernel {kernel}")
    parts = re.findall(r"Depends: (linux-(?:binary|modules)-\S+)",
                       call("apt-cache", "depends", package[1]))
    call("apt-get", "-q", "download", package[1], *parts, cwd=folder)
    for archive in Path(folder).glob("*.deb"):
        call("dpkg-deb", "-x", archive, folder)


def call(*command, **options):
    result = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, **options)
    if result.returncode != 0:
        raise Unavailable(f"{' '.join(map(str, command))}: {result.stderr.strip()}")
    return result.stdout


def shared_libraries(programs):
    """What the programs are linked with, with the loader."""
    return {Path(path) for program in programs
            for path in re.findall(r"(/\S+) \(0x", call("ldd", program))}


def make_initrd(path, program, others, modules):
    """An archive of files, not compressed, that the kernel takes for its first file system."""
    files = {"init": program} | {file.name: file for file in (*others, *modules)}
    files |= {str(library).lstrip("/"): library
              for library in sorted(shared_libraries([program, *others]))}
    folders = {str(parent) for name in files for parent in Path(name).parents} - {"."}
    with open(path, "wb") as archive:
        for name in sorted(folders | {"dev", "proc", "sys"}):
            archive.write(cpio_entry(name, 0o040755))
        for name, source in files.items():
            archive.write(cpio_entry(name, 0o100755, source.read_bytes()))
        archive.write(cpio_entry("TRAILER!!!", 0))


def cpio_entry(name, mode, data=b""):
    """One file in the format newc; nothing in it depends on the day or on who makes it."""
    inode, owner, group, links, mtime, device = 0, 0, 0, 1, 0, (0, 0)
    fields = [inode, mode, owner, group, links, mtime, len(data), *device, 0, 0, len(name) + 1, 0]
    header = b"070701" + b"".join(b"%08X" % field for field in fields)
    return pad(header + name.encode() + b"\0") + pad(data)


def pad(data):
    return data + bytes(-len(data) % 4)


def run(program, others, variables, folder, records, timeout):
    """Runs the machine until it switches itself off, with the program as /init and others
    beside it.

    The variables are in the environment of the program. The kernel writes to the first
    serial line, which goes to console.log in the folder; /dev/ttyS1 goes to the file `records`.
    """
    initrd = folder / "initrd"
    make_initrd(initrd, program, others, [folder / f"{module}.ko" for module in MODULES])
    subprocess.run(
        [QEMU, "-accel", "tcg", "-icount", "shift=2,sleep=off", "-M", "q35", "-cpu", "Nehalem",
         "-smp", "1", "-m", "256M", "-rtc", "base=2026-01-01,clock=vm", "-seed", "1",
         "-nodefaults", "-display", "none", "-no-reboot",
         "-serial", f"file:{folder / 'console.log'}", "-serial", f"file:{records}",
         "-kernel", folder / "vmlinuz", "-initrd", initrd,
         # nokaslr: addresses are the same in each run. preempt: a process that wakes runs at once.
         # panic: where /init dies the machine ends. The rest saves half of the time.
         "-append", "console=ttyS0 quiet nokaslr preempt=full panic=-1 cryptomgr.notests "
                    "mitigations=off " + " ".join(f"{k}={v}" for k, v in variables.items())],
        stdin=subprocess.DEVNULL, timeout=timeout, check=True)
