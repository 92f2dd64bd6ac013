"""H.264 of pictures that are not compressed (I_PCM macroblocks, ITU-T H.264, 7.3.5), and its packets by RTP (RFC 6184).

FFmpeg in OpenCV decodes H.264 and encodes none; such a stream needs no more than headers.
"""

from __future__ import annotations

import socket
import struct
import threading
import time
from contextlib import contextmanager

import cv2
import numpy as np

MTU = 1400
CLOCK, RATE_HZ = 90000, 12


class Bits:
    """Bits of a unit, the highest first."""

    def __init__(self):
        self._bits = []

    def put(self, value, n):
        self._bits += [value >> shift & 1 for shift in range(n - 1, -1, -1)]

    def golomb(self, value):
        """ue(v)."""
        n = (value + 1).bit_length()
        self.put(value + 1, 2 * n - 1)

    def align(self):
        self._bits += [0] * (-len(self._bits) % 8)

    def end(self):
        """rbsp_trailing_bits."""
        self.put(1, 1)
        self.align()

    def bytes(self):
        return np.packbits(np.array(self._bits, np.uint8)).tobytes()


def _unit(header, payload):
    """A unit with its emulation prevention."""
    out, zeros = bytearray([header]), 0
    for byte in payload:
        if zeros >= 2 and byte <= 3:
            out.append(3)
            zeros = 0
        out.append(byte)
        zeros = zeros + 1 if byte == 0 else 0
    return bytes(out)


def parameter_sets(width, height):
    sps = Bits()
    for value, n in ((66, 8), (0xC0, 8), (30, 8)):
        sps.put(value, n)
    for value in (0, 0, 2, 0):
        sps.golomb(value)
    sps.put(0, 1)
    sps.golomb(width // 16 - 1)
    sps.golomb(height // 16 - 1)
    for flag in (1, 1, 0, 0):
        sps.put(flag, 1)
    sps.end()
    pps = Bits()
    pps.golomb(0)
    pps.golomb(0)
    pps.put(0, 2)
    for _ in range(3):
        pps.golomb(0)
    pps.put(0, 3)
    for _ in range(3):
        pps.golomb(0)
    pps.put(0, 3)
    pps.end()
    return _unit(0x67, sps.bytes()), _unit(0x68, pps.bytes())


def keyframe(picture, number):
    """A picture, shape (h, w, 3), blue, green, red, as an IDR slice."""
    height, width = picture.shape[:2]
    planes = cv2.cvtColor(picture, cv2.COLOR_BGR2YUV_I420).reshape(-1)
    n = height * width
    y = planes[:n].reshape(height, width)
    u, v = (planes[n + i * n // 4 : n + (i + 1) * n // 4].reshape(height // 2, width // 2) for i in (0, 1))
    head = Bits()
    for value in (0, 7, 0):
        head.golomb(value)
    head.put(0, 4)
    head.golomb(number % 2)
    head.put(0, 2)
    head.golomb(0)
    content = b""
    for row in range(height // 16):
        for column in range(width // 16):
            block = head if not content else Bits()
            block.golomb(25)
            block.align()
            content += block.bytes()
            large, small = np.s_[16 * row : 16 * row + 16, 16 * column : 16 * column + 16], None
            small = np.s_[8 * row : 8 * row + 8, 8 * column : 8 * column + 8]
            content += y[large].tobytes() + u[small].tobytes() + v[small].tobytes()
    return _unit(0x65, content + b"\x80")


def packets(units, sequence, timestamp, payload_type=96):
    """Packets of the units of one picture: single ones, and FU-A of those that are larger."""
    pieces = []
    for unit in units:
        if len(unit) <= MTU:
            pieces.append(unit)
            continue
        header, body = unit[0], unit[1:]
        parts = [body[at : at + MTU] for at in range(0, len(body), MTU)]
        for n, part in enumerate(parts):
            start, end = n == 0, n == len(parts) - 1
            pieces.append(bytes([header & 0x60 | 28, start << 7 | end << 6 | header & 0x1F]) + part)
    for n, piece in enumerate(pieces):
        is_last = n == len(pieces) - 1
        yield (
            struct.pack(">BBHII", 0x80, is_last << 7 | payload_type, (sequence + n) & 0xFFFF, timestamp & 0xFFFFFFFF, 7)
            + piece
        )


def film_packets(number, payload_type=96):
    """Packets of picture `number` of a film: a red square that goes to the right; sequence numbers count on."""
    picture = np.full((96, 128, 3), 40, np.uint8)
    at = 4 * (number % 20)
    picture[40:60, at : at + 20] = (0, 0, 255)
    units = (*parameter_sets(128, 96), keyframe(picture, number))
    return list(packets(units, 40 * number, number * CLOCK // RATE_HZ, payload_type))


@contextmanager
def sent_by_rtp(payload_type=96):
    """Send the film to a port of this computer; yields the port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    is_over = threading.Event()

    def send():
        number = 0
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            while not is_over.is_set():
                for packet in film_packets(number, payload_type):
                    sender.sendto(packet, ("127.0.0.1", port))
                number += 1
                time.sleep(1.0 / RATE_HZ)

    thread = threading.Thread(target=send, daemon=True)
    thread.start()
    try:
        yield port
    finally:
        is_over.set()
        thread.join()
