// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/digest.h"

#include <array>
#include <bit>
#include <cerrno>
#include <fstream>
#include <stdexcept>

#include <opencv2/imgproc.hpp>
#include <openssl/evp.h>

#include "base/failure_text.h"

namespace disparityd::tools {

namespace {

/// Begins with the shape: pictures of two shapes may have the same pixels.
Sha256 begin(int width, int height, int channels, std::size_t bits) {
    const std::string shape = std::to_string(width) + ' ' + std::to_string(height) + ' ' + std::to_string(channels) +
                              ' ' + std::to_string(bits) + '\n';
    Sha256 digest;
    digest.add(shape.data(), shape.size());
    return digest;
}

}  // namespace

static_assert(std::endian::native == std::endian::little, "pixels are hashed as they lie in memory");

void Sha256::Free::operator()(evp_md_ctx_st* context) const {
    EVP_MD_CTX_free(context);
}

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) {
        throw std::runtime_error("OpenSSL offers no SHA-256 here");
    }
}

void Sha256::add(const void* bytes, std::size_t count) {
    EVP_DigestUpdate(context_.get(), bytes, count);
}

std::string Sha256::hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
    std::string text;
    for (unsigned int i = 0; i < size; ++i) {
        constexpr const char* digits = "0123456789abcdef";
        text += digits[digest[i] >> 4U];
        text += digits[digest[i] & 15U];
    }
    return text;
}

std::string sha256(std::string_view text) {
    Sha256 digest;
    digest.add(text.data(), text.size());
    return digest.hex();
}

std::string sha256_of_file(const std::string& path, const std::function<bool()>& stop) {
    std::ifstream file(path, std::ios::binary);
    Sha256 digest;
    std::array<char, 65536> bytes{};
    while (file.read(bytes.data(), bytes.size()) || file.gcount() > 0) {
        if (stop && stop()) {
            return {};
        }
        digest.add(bytes.data(), static_cast<std::size_t>(file.gcount()));
    }
    if (!file.eof()) {
        throw std::invalid_argument(path + ": cannot be read: " + base::error_text(errno));
    }
    return digest.hex();
}

std::string sha256(const calibration::Rectification& maps) {
    if (maps.left.xy.empty()) {
        return {};
    }
    Sha256 digest;
    for (const calibration::Rectification::Maps* eye : {&maps.left, &maps.right}) {
        digest.add(eye->xy.data(), eye->xy.size() * sizeof(std::int16_t));
        digest.add(eye->fraction.data(), eye->fraction.size() * sizeof(std::uint16_t));
    }
    return digest.hex();
}

std::string sha256(const cv::Mat& picture) {
    cv::Mat pixels;  // of its own: a picture that is handed over as the place for the result is changed
    if (picture.type() == CV_8UC3) {
        cv::cvtColor(picture, pixels, cv::COLOR_BGR2RGB);
    } else {
        pixels = picture;
    }
    Sha256 digest = begin(pixels.cols, pixels.rows, pixels.channels(), pixels.elemSize1() * 8);
    for (int y = 0; y < pixels.rows; ++y) {
        digest.add(pixels.ptr(y), static_cast<std::size_t>(pixels.cols) * pixels.elemSize());
    }
    return digest.hex();
}

std::string sha256(const images::FloatMap& map) {
    Sha256 digest = begin(map.width, map.height, 1, 32);
    digest.add(map.values.data(), map.values.size() * sizeof(float));
    return digest.hex();
}

}  // namespace disparityd::tools
