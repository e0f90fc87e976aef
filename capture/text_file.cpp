// SPDX-License-Identifier: Apache-2.0
#include "capture/text_file.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "capture/words.h"

namespace disparityd::capture {

std::string read_text_file(const std::string& path, std::string_view what) {
    constexpr std::uintmax_t largest = 1U << 20U;
    const std::string where = std::string(what) + " " + path + ": ";
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) {
        throw std::invalid_argument(where + "no such file");
    }
    if (!std::filesystem::is_regular_file(status)) {
        throw std::invalid_argument(where + "not a file");
    }
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error || size > largest) {
        throw std::invalid_argument(where + "found " + std::to_string(size) + " bytes, allowed are 1 MiB of text");
    }
    std::ifstream file(path, std::ios::binary);
    std::string text(static_cast<std::size_t>(size), '\0');
    if (!file.read(text.data(), static_cast<std::streamsize>(size))) {
        throw std::invalid_argument(where + "cannot be read: check its permissions");
    }
    const std::string start = lower_case(trim(std::string_view(text).substr(0, 200)));
    if (start.starts_with("<!doctype") || start.starts_with("<html") || start.starts_with("<head")) {
        throw std::invalid_argument(where +
                                    "found a web page: the download failed and an error page was saved; fetch the "
                                    "file again");
    }
    return text;
}

}  // namespace disparityd::capture
