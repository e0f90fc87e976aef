// SPDX-License-Identifier: Apache-2.0
#include "formats/pictures/jpeg_writer.h"

#include <stdexcept>

#include <turbojpeg.h>

namespace disparityd::formats {
namespace {

/// Owns the library's state.
class JpegCompressor {
public:
    ~JpegCompressor() { tjDestroy(handle_); }

    std::string compress(const JpegPixels& pixels, int quality, JpegTransform transform) {
        const int sampling = pixels.grey ? TJSAMP_GRAY : TJSAMP_420;
        std::string bytes(tjBufSize(pixels.width, pixels.height, sampling), '\0');
        auto* to = reinterpret_cast<unsigned char*>(bytes.data());
        unsigned long size = bytes.size();
        const int flags = TJFLAG_NOREALLOC | (transform == JpegTransform::accurate ? TJFLAG_ACCURATEDCT : 0);
        if (tjCompress2(handle_, pixels.data, pixels.width, pixels.row_bytes, pixels.height,
                        pixels.grey ? TJPF_GRAY : TJPF_BGR, &to, &size, sampling, quality, flags) != 0) {
            throw std::runtime_error(std::string("an image cannot be compressed: ") + tjGetErrorStr2(handle_));
        }
        bytes.resize(size);
        return bytes;
    }

private:
    tjhandle handle_ = tjInitCompress();
};

}  // namespace

std::string jpeg_of(const JpegPixels& pixels, int quality, JpegTransform transform) {
    thread_local JpegCompressor compressor;
    return compressor.compress(pixels, quality, transform);
}

}  // namespace disparityd::formats
