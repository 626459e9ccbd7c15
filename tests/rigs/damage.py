"""What can become of files and of a directory of files: by accident, by another program, by somebody who means it.

A damage is a function of the path it hits, a random number generator and a folder outside for what links lead to. Each
is called by a name; `expect` says what may come of it beside a refusal.
"""

import contextlib
import os
import shutil
import socket
import struct
import zlib

SECRET = b"this belongs to somebody else\n"
ESCAPES = b"\x1b]0;owned\x07\x1b[2J\xff\xfe\x00"
DAMAGES = {}
RECORDING_MAGIC = b"StatorRn"


def damage(
    *, kept=True, recording=True, temporary=False, lock=False, forged=False, harmless=False, factory=False, behind=False
):
    """Where it may happen: in a file that is kept, in a recording, in what a replacement left behind, in the lock.
    `forged`: checksums fit, so any content may be found. `harmless`: the content is that of before. `factory`: the
    file is not there any more. `behind`: nothing is changed but what follows the content."""

    def register(function):
        function.kept, function.recording, function.temporary, function.lock = kept, recording, temporary, lock
        function.forged, function.harmless = forged, harmless
        function.factory, function.behind = factory, behind
        DAMAGES[function.__name__] = function
        return function

    return register


def _replace(path, content):
    path.unlink(missing_ok=True)
    path.write_bytes(content)


# Content


@damage()
def cut(path, rng, _outside):
    os.truncate(path, rng.randrange(path.stat().st_size))


@damage()
def cut_near_the_end(path, rng, _outside):
    os.truncate(path, max(0, path.stat().st_size - rng.randrange(1, 80)))


@damage()
def empty(path, _rng, _outside):
    os.truncate(path, 0)


@damage()
def flipped_bits(path, rng, _outside):
    content = bytearray(path.read_bytes())
    for at in {rng.randrange(len(content)) for _ in range(rng.choice((1, 1, 2, 8)))}:
        content[at] ^= 1 << rng.randrange(8)
    _replace(path, content)


@damage()
def flipped_bits_at_the_begin(path, rng, _outside):
    content = bytearray(path.read_bytes())
    content[rng.randrange(min(60, len(content)))] ^= 1 << rng.randrange(8)
    _replace(path, content)


@damage()
def zeros_in_it(path, rng, _outside):
    content = bytearray(path.read_bytes())
    begin = rng.randrange(len(content))
    length = rng.choice((1, 16, 512, 4096))
    content[begin : begin + length] = bytes(len(content[begin : begin + length]))
    _replace(path, content)


@damage()
def bytes_missing(path, rng, _outside):
    content = bytearray(path.read_bytes())
    begin = rng.randrange(len(content))
    del content[begin : begin + rng.choice((1, 4, 32, 512))]
    _replace(path, content)


@damage()
def bytes_too_many(path, rng, _outside):
    content = bytearray(path.read_bytes())
    begin = rng.randrange(len(content))
    content[begin:begin] = rng.randbytes(rng.choice((1, 4, 32, 512)))
    _replace(path, content)


@damage(behind=True)
def garbage_behind_it(path, rng, _outside):
    with path.open("ab") as file:
        file.write(rng.choice((rng.randbytes(rng.randrange(1, 300)), b"Srec" + rng.randbytes(40), ESCAPES)))


@damage()
def parts_in_another_order(path, rng, _outside):
    content = path.read_bytes()
    marks = [at for at in range(len(content)) if content.startswith(b"Srec", at)]
    if len(marks) < 2:
        marks = sorted(rng.sample(range(len(content)), 2)) if len(content) > 1 else [0, 0]
    ends = [*marks[1:], len(content)]
    parts = [content[begin:end] for begin, end in zip(marks, ends, strict=True)]
    rng.shuffle(parts)
    _replace(path, content[: marks[0]] + b"".join(parts))


@damage()
def part_twice(path, rng, _outside):
    content = path.read_bytes()
    begin, end = sorted((rng.randrange(len(content) + 1), rng.randrange(len(content) + 1)))
    _replace(path, content[:end] + content[begin:end] + content[end:])


@damage()
def noise(path, rng, _outside):
    _replace(path, rng.randbytes(rng.choice((1, 7, 100, 5000))))


@damage()
def escapes(path, rng, _outside):
    content = path.read_bytes()
    words = content.split(b"\n", 1)[0].split(b" ")
    words[rng.randrange(len(words))] = ESCAPES.replace(b"\0", b"")
    _replace(path, rng.choice((ESCAPES, b" ".join(words) + content[content.find(b"\n") :])))


@damage(recording=False)
def another_version(path, rng, _outside):
    content = path.read_bytes()
    _replace(
        path,
        content.replace(
            b"stator 1",
            rng.choice(
                (b"stator 2", b"stator 0", b"stator 18446744073709551617", b"stator -1", b"STATOR 1", b"stator")
            ),
            1,
        ),
    )


@damage(recording=False)
def wrong_numbers(path, rng, _outside):
    line, _, rest = path.read_bytes().partition(b"\n")
    words = line.split(b" ")
    words[min(3, len(words) - 1)] = rng.choice(
        (b"0", b"-1", b"99999999999999999999", b"18446744073709551615", b"4294967296", b"1e9", b"0x10", b"")
    )
    _replace(path, b" ".join(words) + b"\n" + rest)


@damage(recording=False)
def no_end_of_line(path, rng, _outside):
    _replace(path, b"stator 1 eeprom " + b"9" * rng.choice((10, 1000, 1 << 20)))


@damage(recording=False)
def the_file_of_another(path, rng, outside):
    others = [each for each in path.parent.iterdir() if each != path and each.name != "lock"]
    _replace(path, rng.choice(others or [path]).read_bytes())


@damage(recording=False, forged=True)
def forged_content(path, rng, _outside):
    line, _, rest = path.read_bytes().partition(b"\n")
    words = line.split(b" ")
    if len(words) < 6:
        return
    length = int(words[3])
    content = bytearray(rest[:length])
    for _ in range(rng.choice((1, 4, 100))):
        if content:
            content[rng.randrange(len(content))] = rng.choice((0, 0xFF, rng.randrange(256)))
    if rng.random() < 0.3:
        del content[rng.randrange(len(content) + 1) :]
    words[3], words[4] = str(len(content)).encode(), _like(words[4], zlib.crc32(content))
    _replace(path, b" ".join(words) + b"\n" + content)


def _like(word, number):
    """As the checksum is written there."""
    return (b"%0*X" if word.upper() == word else b"%0*x") % (len(word), number)


@damage(kept=False, forged=True)
def forged_chunk(path, rng, _outside):
    """A recording whose checksums fit what was changed."""
    content = path.read_bytes()
    chunks = []
    at = len(RECORDING_MAGIC)
    while at + 8 <= len(content):
        length = struct.unpack_from("<I", content, at)[0]
        chunks.append(bytearray(content[at + 8 : at + 8 + length]))
        at += 8 + length
    chunk = chunks[0] if rng.random() < 0.5 else rng.choice(chunks)
    for _ in range(rng.choice((1, 1, 3, 20))):
        at = rng.randrange(min(len(chunk), rng.choice((40, 1 << 20))))
        chunk[at] = rng.choice((0, 0xFF, 0x80, 0x1B, chunk[at] ^ 1 << rng.randrange(8)))
    if rng.random() < 0.3:
        rng.shuffle(chunks)
    _replace(
        path, RECORDING_MAGIC + b"".join(struct.pack("<II", len(each), zlib.crc32(each)) + each for each in chunks)
    )


@damage(kept=False)
def chunk_of_another_length(path, rng, _outside):
    content = bytearray(path.read_bytes())
    at = len(RECORDING_MAGIC)
    for _ in range(rng.randrange(4)):
        length = struct.unpack_from("<I", content, at)[0]
        if at + 8 + length + 8 < len(content):
            at += 8 + length
    struct.pack_into("<I", content, at, rng.choice((0, 1, 0xFFFFFFFF, 0x7FFFFFFF, 256 << 20, 256 << 10)))
    _replace(path, content)


# What is there instead of a file


@damage(temporary=True, lock=True)
def fifo(path, _rng, _outside):
    path.unlink(missing_ok=True)
    os.mkfifo(path)


@damage(temporary=True, lock=True)
def device_node(path, rng, _outside):
    path.unlink(missing_ok=True)
    os.mknod(path, 0o600 | 0o020000, os.makedev(1, rng.choice((3, 5, 9))))  # null, zero, urandom


@damage(temporary=True, lock=True)
def listening_socket(path, _rng, _outside):
    path.unlink(missing_ok=True)
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(path))


@damage(temporary=True, lock=True)
def directory(path, rng, _outside):
    path.unlink(missing_ok=True)
    path.mkdir()
    if rng.random() < 0.5:
        (path / "something").write_bytes(SECRET)


@damage(temporary=True, lock=True)
def link_to_itself(path, _rng, _outside):
    path.unlink(missing_ok=True)
    path.symlink_to(path.name)


@damage(temporary=True, lock=True)
def link_outside(path, rng, outside):
    path.unlink(missing_ok=True)
    path.symlink_to(rng.choice((outside / "secret", "../outside/secret")))


@damage(temporary=True, lock=True)
def hard_link_outside(path, _rng, outside):
    path.unlink(missing_ok=True)
    path.hardlink_to(outside / "secret")


@damage(temporary=True, lock=True, factory=True)
def link_to_nothing(path, _rng, outside):
    path.unlink(missing_ok=True)
    path.symlink_to(outside / "nothing")


@damage(harmless=True)
def link_to_the_same(path, _rng, outside):
    shutil.move(path, outside / "moved")
    path.symlink_to(outside / "moved")


@damage(temporary=True, lock=True)
def endless(path, rng, _outside):
    path.unlink(missing_ok=True)
    with path.open("wb") as file:
        file.write(rng.choice((b"", b"stator 1 eeprom ", RECORDING_MAGIC)))
        file.truncate(1 << 40)


@damage(behind=True)
def endless_behind_it(path, _rng, _outside):
    os.truncate(path, 1 << 40)


@damage(temporary=True, kept=False, recording=False)
def half_written(path, rng, _outside):
    path.write_bytes(rng.randbytes(rng.randrange(1000)))


# The directory


@damage(kept=False, recording=False, harmless=True)
def many_foreign_files(path, rng, _outside):
    for number in range(300):
        (path / f"foreign {number} {rng.randrange(1 << 30)}").write_bytes(SECRET)
    for name in (b"\xff\xfe\x1b[31m", b".hidden", b"a\nb", b"x" * 255):
        with contextlib.suppress(OSError):
            (path / os.fsdecode(name)).write_bytes(SECRET)
