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
    const auto refuse = [&](const std::string& reason) {
        throw std::invalid_argument(std::string(what) + " " + path + ": " + reason);
    };
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::not_found) {
        refuse("no such file");
    }
    if (error) {
        refuse("cannot be read: " + error.message());
    }
    // Reading a pipe or a device may never end.
    if (!std::filesystem::is_regular_file(status)) {
        refuse(std::string("not a file, but ") +
               (std::filesystem::is_directory(status) ? "a folder" : "a pipe or a device"));
    }
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) {
        refuse("cannot be read: " + error.message());
    }
    if (size > largest) {
        refuse("found " + std::to_string(size) + " bytes, allowed are 1 MiB of text");
    }
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    std::string text(static_cast<std::size_t>(size), '\0');
    if (!file || !file.read(text.data(), static_cast<std::streamsize>(size))) {
        refuse("cannot be read" + (errno != 0 ? ": " + std::string(std::strerror(errno)) : ""));
    }
    const std::string start = lower_case(trim(std::string_view(text).substr(0, 200)));
    if (start.starts_with("<!doctype") || start.starts_with("<html") || start.starts_with("<head")) {
        refuse("found a web page: the download failed and an error page was saved; fetch the file again");
    }
    return text;
}

}  // namespace disparityd::capture
