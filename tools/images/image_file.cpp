// SPDX-License-Identifier: Apache-2.0
#include "tools/images/image_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <vector>

#include <opencv2/imgcodecs.hpp>

namespace disparityd::images {
namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

[[noreturn]] void refuse(const std::string& path) {
    throw std::runtime_error(path + ": cannot be written: " + std::strerror(errno));
}

}  // namespace

void write_file(const std::string& path, std::span<const std::uint8_t> bytes) {
    std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "wb"));
    if (!file || std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) {
        refuse(path);
    }
    if (std::fclose(file.release()) != 0) {
        refuse(path);
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
