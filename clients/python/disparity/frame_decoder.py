# SPDX-License-Identifier: Apache-2.0
"""Makes frames of the messages of a socket."""
from __future__ import annotations

import typing

from . import disparity_pb2 as pb
from .errors import DisparityError
from .frame import Frame, frame_of_message, plane_array, product_name
from .stream import raw_bytes

if typing.TYPE_CHECKING:
    import zstandard


class FrameDecoder:
    """Unpacks the planes of frames, also of compressed ones once expect_compressed() was called."""

    def __init__(self) -> None:
        self._decompress: zstandard.ZstdDecompressor | None = None

    def expect_compressed(self) -> None:
        """Raises ImportError where the module zstandard is missing."""
        if self._decompress is None:
            import zstandard  # only needed for this

            self._decompress = zstandard.ZstdDecompressor()

    def frame(self, message: pb.Frame, payload: bytearray) -> Frame:
        frame = frame_of_message(message)
        offset = 0
        for plane in message.planes:
            data = memoryview(payload)[offset : offset + plane.payload_bytes]
            offset += plane.payload_bytes
            if plane.encoding == pb.ZSTD:
                data = self._unpack(plane, data)
            frame.planes[plane.product] = plane_array(
                plane.product, plane.width, plane.height, plane.bytes_per_pixel, data
            )
        return frame

    def _unpack(self, plane: pb.PlaneInfo, data: memoryview) -> memoryview:
        """Returns one plane decompressed. It never writes more bytes than the plane has."""
        if self._decompress is None:
            raise DisparityError("the daemon sent a compressed frame that nobody asked for")
        wanted = raw_bytes(plane)
        reader = self._decompress.stream_reader(data)
        out = bytearray(wanted + 1)
        filled = 0
        try:
            while filled < len(out):
                got = reader.readinto(memoryview(out)[filled:])
                if got == 0:
                    break
                filled += got
        except Exception as error:  # zstandard's own class, which this module does not import
            raise DisparityError(f"compressed plane of {product_name(plane.product)} is damaged: {error}") from None
        if filled != wanted:
            raise DisparityError(
                f"compressed plane of {product_name(plane.product)} is damaged: {filled} of {wanted} bytes"
            )
        return memoryview(out)[:wanted]
