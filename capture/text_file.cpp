// SPDX-License-Identifier: Apache-2.0
#include "capture/text_file.h"

#include <cerrno>
#include <cstdint>
#include <cstring>
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
    if (status.type() == std::filesystem::file_type::not_found) {
        throw std::invalid_argument(where + "no such file");
    }
    if (error) {
        throw std::invalid_argument(where + "cannot be read: " + error.message());
    }
    // Reading a pipe or a device may never end.
    if (!std::filesystem::is_regular_file(status)) {
        throw std::invalid_argument(where + "not a file, but " +
                                    (std::filesystem::is_directory(status) ? "a folder" : "a pipe or a device"));
    }
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) {
        throw std::invalid_argument(where + "cannot be read: " + error.message());
    }
    if (size > largest) {
        throw std::invalid_argument(where + "found " + std::to_string(size) + " bytes, allowed are 1 MiB of text");
    }
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    std::string text(static_cast<std::size_t>(size), '\0');
    if (!file || !file.read(text.data(), static_cast<std::streamsize>(size))) {
        throw std::invalid_argument(where + "cannot be read" +
                                    (errno != 0 ? ": " + std::string(std::strerror(errno)) : ""));
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
