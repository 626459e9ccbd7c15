"""Directories for kept files on disks that can be spoilt: full, not writable, or without supply.

Each belongs to a process that has its mounts for itself (have_own_mounts) and is root.
"""

import contextlib
import ctypes
import fcntl
import os
import pathlib
import shutil
import struct
import subprocess
import time

CLONE_NEWNS = 0x20000
FS_IMMUTABLE = 0x10
FS_IOC_GETFLAGS, FS_IOC_SETFLAGS = 0x80086601, 0x40086602


def have_own_mounts():
    """From now on what this process mounts is seen by it and its children alone, and ends with them."""
    if ctypes.CDLL(None, use_errno=True).unshare(CLONE_NEWNS) != 0:
        raise PermissionError("disks that can be spoilt need mounts of their own: run as root")
    _run("mount", "--make-rprivate", "/")


def _run(*words):
    subprocess.run(words, check=True, stdin=subprocess.DEVNULL, capture_output=True)


class Place:
    """A directory on the machine's disk. `spoil` makes it worse at some moment of a run, `mend` good again."""

    def __init__(self, directory):
        self.directory = pathlib.Path(directory)
        self.state = self.directory / "state"
        self.make()

    def make(self):
        self.state.mkdir()

    def spoil(self, rng):
        """Nothing happens to a good disk."""

    def mend(self):
        pass

    def close(self):
        self.mend()
        shutil.rmtree(self.state, ignore_errors=True)


class FullPlace(Place):
    """A small disk that runs full: with some pages left, or none."""

    SIZE = 8 << 20

    def make(self):
        self.disk = self.directory / "disk"
        self.disk.mkdir()
        _run("mount", "-t", "tmpfs", "-o", f"size={self.SIZE}", "none", self.disk)
        self.state = self.disk / "state"
        self.state.mkdir()

    def spoil(self, rng):
        left = rng.choice((0, 0, 4096, 8192, 65536))
        with open(self.disk / "ballast", "wb", buffering=0) as ballast, contextlib.suppress(OSError):
            while True:
                room = os.statvfs(self.disk)
                size = room.f_bavail * room.f_bsize - left
                if size <= 0:
                    break
                os.posix_fallocate(ballast.fileno(), ballast.seek(0, os.SEEK_END), size)

    def mend(self):
        (self.disk / "ballast").unlink(missing_ok=True)

    def close(self):
        _run("umount", "-l", self.disk)


class ReadOnlyPlace(Place):
    """Nothing can be created, renamed or deleted in the directory any more, and sometimes none of its files be
    written. A file system with a file open for writing, as the lock is, cannot be remounted read-only."""

    def make(self):
        self.locked = []
        super().make()

    def spoil(self, rng):
        self._lock(self.state)
        if rng.random() < 0.5:
            for each in self.state.iterdir():
                if each.is_file():
                    self._lock(each)

    def _lock(self, path):
        _set_immutable(path, True)
        self.locked.append(path)

    def mend(self):
        for each in self.locked:
            _set_immutable(each, False)
        self.locked = []


class PowerCutPlace(Place):
    """A disk that loses its supply: what was not brought to it is gone when it is back.

    It is what its image holds at that moment, so whoever writes to it is to be stopped before (SIGSTOP).
    EXT4_IOC_SHUTDOWN would be simpler, but lets fdatasync succeed for what it loses: an append of 64 bytes by a
    program of ten lines, in one of 20 cuts (Linux 6.18)."""

    def make(self):
        self.image = self.directory / "image"
        self.kept = self.directory / "kept"
        self.disk = self.directory / "disk"
        self.disk.mkdir()
        with open(self.image, "wb") as image:
            image.truncate(16 << 20)
        _run("mkfs.ext4", "-q", "-F", "-J", "size=4", self.image)
        self._mount()
        self.state = self.disk / "state"
        self.state.mkdir()
        os.sync()

    def _mount(self):
        _run("mount", "-o", "loop", self.image, self.disk)

    def spoil(self, rng):
        # What was under way when the program was stopped comes to its end first: half of it is no image.
        before, content = None, self.image.read_bytes()
        while content != before:
            time.sleep(0.005)
            before, content = content, self.image.read_bytes()
        self.kept.write_bytes(content)

    def mend(self):
        if self.kept.exists():
            _run("umount", self.disk)
            self.kept.replace(self.image)
            self._mount()

    def close(self):
        _run("umount", self.disk)
        self.image.unlink()


def _set_immutable(path, immutable):
    descriptor = os.open(path, os.O_RDONLY)
    try:
        flags = bytearray(8)
        fcntl.ioctl(descriptor, FS_IOC_GETFLAGS, flags)
        value = struct.unpack("l", flags)[0]
        value = value | FS_IMMUTABLE if immutable else value & ~FS_IMMUTABLE
        fcntl.ioctl(descriptor, FS_IOC_SETFLAGS, struct.pack("l", value))
    finally:
        os.close(descriptor)
