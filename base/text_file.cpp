// SPDX-License-Identifier: Apache-2.0
#include "base/text_file.h"

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "base/failure_text.h"
#include "base/words.h"

namespace disparityd::base {

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
        refuse("cannot be read: " + error_text(error.value()));
    }
    // Reading a pipe or a device may never end.
    if (!std::filesystem::is_regular_file(status)) {
        refuse(std::string("not a file, but ") +
               (std::filesystem::is_directory(status) ? "a folder" : "a pipe or a device"));
    }
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) {
        refuse("cannot be read: " + error_text(error.value()));
    }
    if (size > largest) {
        refuse("found " + std::to_string(size) + " bytes, allowed are 1 MiB of text");
    }
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    std::string text(static_cast<std::size_t>(size), '\0');
    if (!file || !file.read(text.data(), static_cast<std::streamsize>(size))) {
        refuse("cannot be read" + (errno != 0 ? ": " + error_text(errno) : ""));
    }
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
        refuse("found UTF-16 text: save it as UTF-8");
    }
    text.erase(0, text.size() - without_byte_order_mark(text).size());
    const std::string start = lower_case(trim(std::string_view(text).substr(0, 200)));
    if (start.starts_with("<!doctype") || start.starts_with("<html") || start.starts_with("<head")) {
        refuse("found a web page: the download failed and an error page was saved; fetch the file again");
    }
    return text;
}

std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

}  // namespace disparityd::base
