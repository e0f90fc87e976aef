// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <new>
#include <stdexcept>

#include <turbojpeg.h>

#include "capture/images/image_decoders.h"

namespace disparityd::capture {
namespace {

struct DestroyDecoder {
    void operator()(void* decoder) const { tjDestroy(decoder); }
};

}  // namespace

// A file that was cut off or is damaged gives grey areas and shifted blocks without an error of the decoder, which only
// warns: it is refused here.
cv::Mat decode_jpeg(std::span<const std::uint8_t> file, const std::string& path) {
    const std::unique_ptr<void, DestroyDecoder> decoder(tjInitDecompress());
    if (decoder == nullptr) {
        throw std::bad_alloc();
    }
    const auto refuse = [&](const std::string& why) { throw std::invalid_argument(path + ": " + why); };
    const auto size = static_cast<unsigned long>(file.size());
    int width = 0, height = 0, subsampling = 0, space = 0;
    if (tjDecompressHeader3(decoder.get(), file.data(), size, &width, &height, &subsampling, &space) != 0) {
        refuse(std::string("is a JPEG that cannot be read: ") + tjGetErrorStr2(decoder.get()));
    }
    if (space == TJCS_CMYK || space == TJCS_YCCK) {
        refuse("found a JPEG of four inks (CMYK), allowed are grey and colour: convert it");
    }
    const bool grey = space == TJCS_GRAY;
    cv::Mat image(height, width, grey ? CV_8UC1 : CV_8UC3);
    if (tjDecompress2(decoder.get(), file.data(), size, image.data, width, static_cast<int>(image.step), height,
                      grey ? TJPF_GRAY : TJPF_BGR, TJFLAG_ACCURATEDCT) != 0) {
        refuse(std::string("is damaged: ") + tjGetErrorStr2(decoder.get()));
    }
    return image;
}

}  // namespace disparityd::capture
