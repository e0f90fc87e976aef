// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <opencv2/core.hpp>

#include "calibration/rectification.h"
#include "tools/images/disparity_map.h"

struct evp_md_ctx_st;

namespace disparityd::tools {

/// The SHA-256 of what it is given, one piece after the other.
class Sha256 {
public:
    Sha256();  ///< throws std::runtime_error where OpenSSL has none
    void add(const void* bytes, std::size_t count);
    std::string hex();  ///< 64 digits; nothing can be added afterwards

private:
    struct Free {
        void operator()(evp_md_ctx_st* context) const;
    };
    std::unique_ptr<evp_md_ctx_st, Free> context_;
};

std::string sha256(std::string_view text);

/// Returns the SHA-256 of a file's bytes. Throws std::invalid_argument when it cannot be read. `stop` is asked now and
/// then: what it ends is empty.
std::string sha256_of_file(const std::string& path, const std::function<bool()>& stop = {});

/// Returns the SHA-256 of the maps of both eyes, as they lie in memory; empty: pixels are used as they are.
std::string sha256(const calibration::Rectification& maps);

/// Returns the SHA-256 of a picture: of the line "WIDTH HEIGHT CHANNELS BITS\n", and of its pixels behind it, row by
/// row from the top, without gaps: grey of 16 bits little endian, and 8 bits as red, green, blue.
std::string sha256(const cv::Mat& picture);

/// The same of 32-bit floats, little endian; +infinity where a disparity was rejected.
std::string sha256(const images::FloatMap& map);

}  // namespace disparityd::tools
