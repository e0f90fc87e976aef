// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <stdexcept>

#include "base/little_endian.h"
#include "capture/images/image_decoders.h"

namespace disparityd::capture {
namespace {

/// What stands before the pixels. The layouts are those of Windows (40 bytes and more) and of OS/2 (12).
struct BmpHead {
    std::uint64_t pixels_at = 0, header_size = 0, width = 0, rows = 0, bits = 0, compression = 0, colours = 0;
    bool old = false;         ///< OS/2's: a colour of the palette has three bytes, not four
    bool from_above = false;  ///< the top row comes first

    std::uint64_t row_bytes() const { return (width * bits + 31) / 32 * 4; }
};

BmpHead read_bmp_head(std::span<const std::uint8_t> file, const std::string& path) {
    constexpr std::size_t least_head = 26, usual_head = 54;
    const auto number = [&](std::size_t at, std::size_t bytes) {
        return base::get_little_endian(file.data() + at, bytes);
    };
    if (file.size() < least_head || (number(14, 4) != 12 && file.size() < usual_head)) {
        refuse_cut_image(path, file.size(), usual_head);
    }
    BmpHead head{.pixels_at = number(10, 4), .header_size = number(14, 4)};
    head.old = head.header_size == 12;
    if (head.old) {
        head.width = number(18, 2);
        head.rows = number(20, 2);
        head.bits = number(24, 2);
    } else {
        head.width = number(18, 4);
        head.rows = number(22, 4);
        head.bits = number(28, 2);
        head.compression = number(30, 4);
        head.colours = number(46, 4);
    }
    if (head.rows > 0x80000000U) {  // a negative number
        head.rows = 0x100000000U - head.rows;
        head.from_above = true;
    }
    return head;
}

void check_bmp_head(const BmpHead& head, std::span<const std::uint8_t> file, const std::string& path) {
    constexpr std::uint64_t most = largest_image_side, bit_fields = 3;
    // Fields that lie as without them: blue, green, red, each a byte.
    const bool usual_fields = head.compression == bit_fields && head.bits == 32 && file.size() >= 66 &&
                              base::get_little_endian(file.data() + 54, 4) == 0xff0000U &&
                              base::get_little_endian(file.data() + 58, 4) == 0xff00U &&
                              base::get_little_endian(file.data() + 62, 4) == 0xffU;
    if ((head.bits != 8 && head.bits != 24 && head.bits != 32) || (head.compression != 0 && !usual_fields)) {
        throw std::invalid_argument(path + ": found a BMP of " + std::to_string(head.bits) +
                                    " bits for each pixel, packed in way " + std::to_string(head.compression) +
                                    "; allowed are 8, 24 and 32 bits, not packed: convert it to PNG");
    }
    if (head.width == 0 || head.rows == 0 || head.width > most || head.rows > most) {
        throw std::invalid_argument(path + ": is damaged: the header of the BMP says no size");
    }
    const std::uint64_t least = head.pixels_at + head.rows * head.row_bytes();
    if (file.size() < least) {
        refuse_cut_image(path, file.size(), least);
    }
}

using Palette = std::array<cv::Vec3b, 256>;

/// Reads the colours; those that the file does not state are black.
Palette read_palette(const BmpHead& head, std::span<const std::uint8_t> file) {
    Palette palette{};
    const std::size_t begin = 14 + head.header_size;
    const std::size_t step = head.old ? 3 : 4;
    const std::size_t stated = head.colours == 0 ? palette.size() : std::min<std::size_t>(head.colours, palette.size());
    for (std::size_t i = 0; i < stated; ++i) {
        const std::size_t at = begin + i * step;
        if (at + step > std::min<std::size_t>(head.pixels_at, file.size())) {
            break;
        }
        palette[i] = {file[at], file[at + 1], file[at + 2]};
    }
    return palette;
}

bool is_grey(const Palette& palette) {
    return std::all_of(palette.begin(), palette.end(),
                       [](const cv::Vec3b& colour) { return colour[0] == colour[1] && colour[1] == colour[2]; });
}

cv::Mat with_palette(const cv::Mat& stored, const Palette& palette) {
    cv::Mat image(stored.size(), is_grey(palette) ? CV_8UC1 : CV_8UC3);
    for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
            const cv::Vec3b& colour = palette[stored.at<std::uint8_t>(y, x)];
            if (image.channels() == 1) {
                image.at<std::uint8_t>(y, x) = colour[0];
            } else {
                image.at<cv::Vec3b>(y, x) = colour;
            }
        }
    }
    return image;
}

/// Copies each pixel with `copy`, from the rows of the file to those of the image.
template <typename Copy>
void copy_rows(const BmpHead& head, std::span<const std::uint8_t> file, cv::Mat& image, const Copy& copy) {
    for (int y = 0; y < image.rows; ++y) {
        const int row = head.from_above ? y : image.rows - 1 - y;
        const std::uint8_t* from = file.data() + head.pixels_at + static_cast<std::uint64_t>(row) * head.row_bytes();
        std::uint8_t* to = image.ptr(y);
        for (int x = 0; x < image.cols; ++x, from += head.bits / 8, to += image.elemSize()) {
            copy(from, to);
        }
    }
}

}  // namespace

cv::Mat decode_bmp(std::span<const std::uint8_t> file, const std::string& path) {
    const BmpHead head = read_bmp_head(file, path);
    check_bmp_head(head, file, path);
    const cv::Size size(static_cast<int>(head.width), static_cast<int>(head.rows));
    if (head.bits == 8) {
        cv::Mat stored(size, CV_8UC1);
        copy_rows(head, file, stored, [](const std::uint8_t* from, std::uint8_t* to) { *to = *from; });
        return with_palette(stored, read_palette(head, file));
    }
    cv::Mat image(size, CV_8UC3);
    // The fourth byte of 32 bits says nothing of the picture.
    copy_rows(head, file, image, [](const std::uint8_t* from, std::uint8_t* to) { std::copy_n(from, 3, to); });
    return image;
}

}  // namespace disparityd::capture
