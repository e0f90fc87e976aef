// SPDX-License-Identifier: Apache-2.0
#include "formats/bag_file.h"

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <string_view>

#include "base/failure_text.h"
#include "base/file_kind.h"

namespace disparityd::formats {

BagFile::BagFile(const std::string& path) : path_(path) {
    if (!base::is_file(path)) {
        throw std::invalid_argument(path + ": no such file");
    }
    file_.open(path, std::ios::binary);
    if (!file_) {
        throw std::runtime_error(path + ": cannot be read: " + base::error_text(errno));
    }
    file_.seekg(0, std::ios::end);
    size_ = static_cast<std::uint64_t>(std::max<std::streamoff>(file_.tellg(), 0));
    file_.seekg(0);
}

void BagFile::read(std::span<std::uint8_t> into) {
    if (!file_.read(reinterpret_cast<char*>(into.data()), static_cast<std::streamsize>(into.size()))) {
        throw std::runtime_error(path_ + ": cannot be read at byte " + std::to_string(position_) + ": " +
                                 base::error_text(errno));
    }
    position_ += into.size();
}

bool BagFile::read_at(std::uint64_t begin, std::span<std::uint8_t> into) {
    file_.seekg(static_cast<std::streamoff>(begin));
    const bool whole =
        static_cast<bool>(file_.read(reinterpret_cast<char*>(into.data()), static_cast<std::streamsize>(into.size())));
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(position_));
    return whole;
}

void BagFile::fail(const std::string& what) const {
    throw std::runtime_error(path_ + ": is damaged at byte " + std::to_string(position_) + ": " + what);
}

void BagFile::fail_cut_off() const {
    throw std::runtime_error(path_ + ": was cut off after " + std::to_string(size_) +
                             " bytes: what is whole was read, the rest is missing");
}

void BagFile::fail_with(const std::runtime_error& error) const {
    if (std::string_view(error.what()).starts_with(path_)) {
        throw;
    }
    fail(error.what());
}

}  // namespace disparityd::formats
