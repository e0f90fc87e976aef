// SPDX-License-Identifier: Apache-2.0
#include "capture/svo/svo_picture.h"

#include <stdexcept>
#include <utility>

#include <opencv2/imgproc.hpp>
#include <zstd.h>

#include "base/message_text.h"
#include "capture/images/image_files.h"
#include "capture/recording/recording_format.h"
#include "capture/svo/jpeg_strips.h"

namespace disparityd::capture {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// Takes an image of 8 bits as a picture of both eyes.
SvoPicture picture_of(cv::Mat image) {
    SvoPicture picture;
    picture.width = image.cols;
    picture.height = image.rows;
    if (image.type() == CV_8UC1 && image.cols % 4 == 0 && image.cols / 4 >= image.rows) {
        picture.format = PixelFormat::yuyv;
        picture.width = image.cols / 2;
    } else if (image.type() == CV_8UC3) {
        picture.format = PixelFormat::bgr24;
    } else if (image.type() == CV_8UC2) {
        picture.format = PixelFormat::yuyv;
    }
    const int even = picture.format == PixelFormat::yuyv ? 4 : 2;
    if (picture.width % even != 0 || picture.width / 2 < picture.height) {
        throw std::runtime_error("its picture of " + base::size_text(image.cols, image.rows) +
                                 " does not hold two eyes side by side");
    }
    picture.pixels = std::move(image);
    return picture;
}

cv::Mat unpack_zstd(Bytes payload, std::optional<SvoSize> stated) {
    if (!stated) {
        throw std::runtime_error("the file does not say which size the pictures packed by zstd have");
    }
    const auto pixels = static_cast<std::uint64_t>(stated->width) * static_cast<std::uint64_t>(stated->height);
    const unsigned long long size = ZSTD_getFrameContentSize(payload.data(), payload.size());
    const bool nv12 = stated->height % 2 == 0 && size == pixels + pixels / 2;
    const bool raw = size >= pixels && size <= 4 * pixels && size % pixels == 0;
    if (!nv12 && !raw) {
        const bool known = size != ZSTD_CONTENTSIZE_UNKNOWN && size != ZSTD_CONTENTSIZE_ERROR;
        throw std::runtime_error("zstd holds " + (known ? std::to_string(size) : std::string("an unknown number of")) +
                                 " bytes, which is no raw picture of " +
                                 base::size_text(stated->width, stated->height));
    }
    const int rows = nv12 ? stated->height + stated->height / 2 : stated->height;
    cv::Mat image(rows, stated->width, CV_8UC(nv12 ? 1 : static_cast<int>(size / pixels)));
    const std::size_t room = image.total() * image.elemSize();
    const std::size_t made = ZSTD_decompress(image.data, room, payload.data(), payload.size());
    if (ZSTD_isError(made) != 0 || made != room) {
        throw std::runtime_error("zstd data are damaged");
    }
    if (nv12) {
        return image.rowRange(0, stated->height).clone();
    }
    if (image.channels() == 4) {
        cv::cvtColor(image, image, cv::COLOR_BGRA2BGR);
    }
    return image;
}

}  // namespace

SvoPicture unpack_svo_picture(SvoPayload kind, Bytes payload, std::optional<SvoSize> stated) {
    switch (kind) {
        case SvoPayload::png: return picture_of(as_8_bits(decode_image(payload, "a picture"), "a picture"));
        case SvoPayload::jpeg_strips: return picture_of(decode_jpeg_strips(jpeg_strips_of(payload)));
        case SvoPayload::zstd: return picture_of(unpack_zstd(payload, stated));
        case SvoPayload::annex_b:
        case SvoPayload::unknown: break;
    }
    throw std::runtime_error("it is no picture");
}

}  // namespace disparityd::capture
