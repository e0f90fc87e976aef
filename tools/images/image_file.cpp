// SPDX-License-Identifier: Apache-2.0
#include "tools/images/image_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include <opencv2/imgcodecs.hpp>

namespace disparityd::images {
namespace {

[[noreturn]] void refuse(const std::string& path, int error) {
    throw std::runtime_error(path + ": cannot be written: " + std::strerror(error));
}

}  // namespace

void write_file(const std::string& path, std::span<const std::uint8_t> bytes) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (file == nullptr) {
        refuse(path, errno);
    }
    const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    const int reason = errno;
    if (std::fclose(file) != 0 || !written) {
        const int error = written ? errno : reason;
        std::error_code ignored;
        if (std::filesystem::is_regular_file(path, ignored)) {
            std::filesystem::remove(path, ignored);  // half a picture is none
        }
        refuse(path, error);
    }
}

void write_png(const std::string& path, const cv::Mat& picture) {
    std::vector<std::uint8_t> bytes;
    bool encoded = false;
    try {
        encoded = cv::imencode(".png", picture, bytes);
    } catch (const cv::Exception&) {
        encoded = false;
    }
    if (!encoded) {
        throw std::runtime_error(path + ": a picture of " + std::to_string(picture.cols) + " x " +
                                 std::to_string(picture.rows) + " pixels cannot be stored as PNG");
    }
    write_file(path, bytes);
}

cv::Mat read_image(const std::string& path) {
    cv::Mat picture;
    try {
        picture = cv::imread(path, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {
        picture.release();
    }
    if (picture.empty()) {
        throw std::invalid_argument(path + ": is not there or not a picture; allowed: PNG, PGM, PPM, PFM, JPEG");
    }
    return picture;
}

}  // namespace disparityd::images
