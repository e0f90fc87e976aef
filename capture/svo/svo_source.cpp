// SPDX-License-Identifier: Apache-2.0
#include "capture/svo/svo_source.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string_view>

#include "base/file_kind.h"
#include "base/words.h"
#include "capture/recording/recording_source.h"
#include "capture/svo/svo_format.h"
#include "capture/svo/svo_reader.h"
#include "formats/mcap_fields.h"

namespace disparityd::capture {
namespace {

std::string begin_of(const std::string& path) {
    std::array<char, formats::mcap_magic.size()> bytes{};
    std::ifstream file(path, std::ios::binary);
    file.read(bytes.data(), bytes.size());
    return {bytes.data(), static_cast<std::size_t>(file.gcount())};
}

/// Refuses a file that is none of those that are read, by its first bytes.
void check_begin(const std::string& path) {
    const std::string begin = begin_of(path);
    if (!base::is_file(path) || begin == formats::mcap_magic) {
        return;
    }
    if (begin.starts_with(std::string_view("\0SVO", 4)) || begin.starts_with("SVO")) {
        throw std::invalid_argument(path + ": is a recording of the ZED SDK before 4.1 (SVO 1), which only that SDK " +
                                    "can read; its sample \"SVO Export\" makes a side-by-side AVI or images of it");
    }
    if (begin.empty()) {
        throw std::invalid_argument(path + ": is empty; expected an SVO2 recording of the ZED SDK");
    }
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(begin.data());
    throw std::invalid_argument(path + ": is no SVO2 recording (MCAP), or an encrypted one: it begins with the bytes " +
                                first_bytes({bytes, begin.size()}) +
                                "; decrypt or export it with the ZED SDK that recorded it");
}

}  // namespace

bool is_svo(const std::string& uri) {
    const std::string ending = base::lower_case(std::filesystem::path(uri).extension().string());
    return ending == ".svo2" ? uri.find(',') == std::string::npos || base::is_file(uri)
                             : ending == ".svo" && begin_of(uri) == formats::mcap_magic;
}

std::unique_ptr<FrameSource> open_svo(const SourceOptions& options) {
    check_begin(options.uri);
    return play(options, [options] { return std::make_unique<SvoReader>(options); });
}

}  // namespace disparityd::capture
