"""A file system in memory that stops answering when it is told to, as a disk that hangs or a server that is gone.

It speaks the kernel's FUSE protocol (linux/fuse.h, 7.31) itself. While it stalls it does not read requests; who waits
for one can then be killed, as with a network file system mounted "soft,intr".
"""

import ctypes
import errno
import os
import pathlib
import select
import stat
import struct
import threading

LOOKUP, FORGET, GETATTR, SETATTR, MKDIR, UNLINK, RENAME = 1, 2, 3, 4, 9, 10, 12
OPEN, READ, WRITE, STATFS, RELEASE, FSYNC = 14, 15, 16, 17, 18, 20
INIT, OPENDIR, READDIR, RELEASEDIR, FSYNCDIR, CREATE, INTERRUPT = 26, 27, 28, 29, 30, 35, 36
BATCH_FORGET, RENAME2 = 42, 45
ROOT = 1
SETATTR_SIZE = 1 << 3
BIG_WRITES = 1 << 5


class Node:
    def __init__(self, mode):
        self.mode = mode
        self.content = bytearray()
        self.names = {}


class StallingDisk:
    """Mounted at `path` until it is closed. The process must have mounts of its own (places.have_own_mounts)."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.path.mkdir(exist_ok=True)
        self.nodes = {ROOT: Node(stat.S_IFDIR | 0o755)}
        self.device = os.open("/dev/fuse", os.O_RDWR | os.O_NONBLOCK)
        options = f"fd={self.device},rootmode=40000,user_id={os.getuid()},group_id={os.getgid()}".encode()
        libc = ctypes.CDLL(None, use_errno=True)
        if libc.mount(b"stalling", os.fsencode(self.path), b"fuse", 0, options) != 0:
            raise OSError(ctypes.get_errno(), "mounting a FUSE file system")
        self.going = threading.Event()
        self.going.set()
        self.ended = False
        self.thread = threading.Thread(target=self._serve, daemon=True)
        self.thread.start()

    def stall(self):
        # The kernel now learns that nothing is to be done when a file is closed. It would wait for that even in
        # a process that is being killed.
        (self.path / "probe").write_bytes(b"")
        self.going.clear()

    def go_on(self):
        self.going.set()

    def close(self):
        self.ended = True
        self.going.set()
        self.thread.join()
        ctypes.CDLL(None).umount2(os.fsencode(self.path), 2)  # MNT_DETACH
        os.close(self.device)

    def _serve(self):
        while not self.ended:
            self.going.wait()
            if not select.select([self.device], [], [], 0.02)[0] or not self.going.is_set():
                continue
            try:
                request = os.read(self.device, 1 << 18)
            except OSError as error:
                if error.errno in (errno.EAGAIN, errno.EINTR, errno.ENOENT):
                    continue
                return
            _, operation, unique, node = struct.unpack_from("<IIQQ", request)
            if operation in (FORGET, BATCH_FORGET, INTERRUPT):
                continue
            try:
                answer, error = self._answer(operation, node, request[40:]), 0
            except OSError as failure:
                answer, error = b"", -failure.errno
            try:
                os.write(self.device, struct.pack("<IiQ", 16 + len(answer), error, unique) + answer)
            except OSError:
                continue  # who asked is gone

    def _answer(self, operation, number, body):
        if operation == INIT:
            return struct.pack("<IIIIHHIIHHI28x", 7, 31, 1 << 16, BIG_WRITES, 16, 12, 1 << 16, 1, 0, 0, 0)
        node = self.nodes[number]
        if operation == LOOKUP:
            return self._entry(self._find(node, body))
        if operation == GETATTR:
            return struct.pack("<QII", 0, 0, 0) + self._attributes(number)
        if operation == SETATTR:
            valid, _, _, size = struct.unpack_from("<IIQQ", body)
            if valid & SETATTR_SIZE:
                del node.content[size:]
                node.content.extend(bytes(size - len(node.content)))
            return struct.pack("<QII", 0, 0, 0) + self._attributes(number)
        if operation == CREATE:
            name = body[16:].split(b"\0")[0]
            return self._entry(self._make(node, name, stat.S_IFREG | 0o644)) + bytes(16)
        if operation == MKDIR:
            return self._entry(self._make(node, body[8:].split(b"\0")[0], stat.S_IFDIR | 0o755))
        if operation in (OPEN, OPENDIR):
            return bytes(16)
        if operation == READ:
            _, offset, size = struct.unpack_from("<QQI", body)
            return bytes(node.content[offset : offset + size])
        if operation == WRITE:
            _, offset, size = struct.unpack_from("<QQI", body)
            node.content.extend(bytes(max(0, offset - len(node.content))))
            node.content[offset : offset + size] = body[40 : 40 + size]
            return struct.pack("<II", size, 0)
        if operation in (RENAME, RENAME2):
            old, new = body[8 if operation == RENAME else 16 :].split(b"\0")[:2]
            target = self.nodes[struct.unpack_from("<Q", body)[0]]
            target.names[new] = self._find(node, old)
            del node.names[old]
            return b""
        if operation == UNLINK:
            self._find(node, body)
            del node.names[body.split(b"\0")[0]]
            return b""
        if operation == STATFS:
            return struct.pack("<QQQQQIIII24x", 1 << 20, 1 << 20, 1 << 20, 1 << 16, 1 << 16, 4096, 255, 4096, 0)
        if operation == READDIR:
            return self._list(node, struct.unpack_from("<Q", body, 8)[0])
        if operation in (RELEASE, RELEASEDIR, FSYNC, FSYNCDIR):
            return b""
        raise OSError(errno.ENOSYS, "")

    @staticmethod
    def _find(node, name):
        number = node.names.get(name.split(b"\0")[0])
        if number is None:
            raise OSError(errno.ENOENT, "")
        return number

    def _make(self, directory, name, mode):
        number = max(self.nodes) + 1
        self.nodes[number] = Node(mode)
        directory.names[name] = number
        return number

    def _attributes(self, number):
        node = self.nodes[number]
        return struct.pack(
            "<QQQ24xIIIIIIIIII",
            number,
            len(node.content),
            0,
            0,
            0,
            0,
            node.mode,
            1,
            os.getuid(),
            os.getgid(),
            0,
            4096,
            0,
        )

    def _entry(self, number):
        return struct.pack("<QQQQII", number, 0, 0, 0, 0, 0) + self._attributes(number)

    def _list(self, node, offset):
        entries = [*node.names.items()]
        data = b""
        for at, (name, number) in list(enumerate(entries, 1))[offset:]:
            entry = struct.pack("<QQII", number, at, len(name), self.nodes[number].mode >> 12) + name
            data += entry.ljust(-(-len(entry) // 8) * 8, b"\0")
        return data[:3000]
