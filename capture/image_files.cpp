// SPDX-License-Identifier: Apache-2.0
#include "capture/image_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "capture/message_text.h"

namespace disparityd::capture {

namespace {

constexpr int largest_side = 8192;

/// Width and height follow the magic number, with comments between.
std::optional<ImageSize> parse_pnm(std::string_view head) {
    std::array<int, 2> numbers{};
    std::size_t at = 2;
    for (int& number : numbers) {
        for (;;) {
            while (at < head.size() && std::isspace(static_cast<unsigned char>(head[at])) != 0) {
                ++at;
            }
            if (at >= head.size() || head[at] != '#') {
                break;
            }
            at = std::min(head.find('\n', at), head.size());
        }
        const std::size_t start = at;
        while (at < head.size() && std::isdigit(static_cast<unsigned char>(head[at])) != 0 && at - start < 6) {
            number = 10 * number + (head[at] - '0');
            ++at;
        }
        if (at == start || at == head.size()) {
            return std::nullopt;
        }
    }
    return ImageSize{numbers[0], numbers[1]};
}

std::optional<ImageSize> parse_png(std::string_view head) {
    if (head.size() < 24 || head.substr(12, 4) != "IHDR") {
        return std::nullopt;
    }
    const auto number = [&](std::size_t at) {
        std::uint32_t value = 0;
        for (std::size_t i = at; i < at + 4; ++i) {
            value = (value << 8) | static_cast<unsigned char>(head[i]);
        }
        return static_cast<int>(value & 0x7FFFFFFFU);
    };
    return ImageSize{number(16), number(20)};
}

}  // namespace

std::optional<ImageSize> peek_image_size(const std::string& path) {
    std::array<char, 512> bytes{};
    std::ifstream file(path, std::ios::binary);
    file.read(bytes.data(), bytes.size());
    const std::string_view head(bytes.data(), static_cast<std::size_t>(file.gcount()));
    if (head.starts_with("\x89PNG\r\n\x1a\n")) {
        return parse_png(head);
    }
    if (head.size() > 2 && head[0] == 'P' && head[1] >= '1' && head[1] <= '6') {
        return parse_pnm(head);
    }
    return std::nullopt;
}

cv::Mat read_image(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) {
        throw std::invalid_argument(path + ": no such file");
    }
    cv::Mat image;
    try {
        image = cv::imread(path, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {
        image.release();
    }
    if (image.empty()) {
        throw std::invalid_argument(path +
                                    ": is not an image that can be read (PNG, PPM, PGM, JPEG, BMP, TIFF), or is "
                                    "damaged");
    }
    if (image.depth() != CV_8U) {
        throw std::invalid_argument(path + ": found more than 8 bits per channel, allowed are 8: convert it");
    }
    if (image.cols > largest_side || image.rows > largest_side) {
        throw std::invalid_argument(path + ": found " + size_text(image.cols, image.rows) +
                                    " pixels, allowed are up to 8192 on a side");
    }
    if (image.channels() == 4) {
        cv::cvtColor(image, image, cv::COLOR_BGRA2BGR);
    } else if (image.channels() != 1 && image.channels() != 3) {
        throw std::invalid_argument(path + ": found " + std::to_string(image.channels()) +
                                    " channels, allowed are grey and colour");
    }
    return image;
}

std::string unequal_sizes(const std::string& first, ImageSize first_size, const std::string& second,
                          ImageSize second_size) {
    return "images of unequal sizes: " + first + " is " + size_text(first_size.width, first_size.height) + ", " +
           second + " is " + size_text(second_size.width, second_size.height) + "; all must be alike";
}

}  // namespace disparityd::capture
