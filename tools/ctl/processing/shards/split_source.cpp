// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/shards/split_source.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/file_kind.h"
#include "tools/ctl/processing/earlier_run.h"
#include "tools/ctl/processing/process_source.h"

namespace disparityd::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view range_begin = "range-", range_middle = "-of-";
constexpr std::uint64_t most_frames = 1'000'000'000;  // as of --first

std::string name_of(Shard shard) {
    return std::string(range_begin) + std::to_string(shard.index) + std::string(range_middle) +
           std::to_string(shard.count);
}

/// Reads a name back.
std::optional<Shard> shard_of_name(std::string_view name) {
    const std::size_t at = name.find(range_middle);
    if (!name.starts_with(range_begin) || at == std::string_view::npos) {
        return std::nullopt;
    }
    Shard shard;
    std::from_chars(name.data() + range_begin.size(), name.data() + at, shard.index);
    std::from_chars(name.data() + at + range_middle.size(), name.data() + name.size(), shard.count);
    return name == name_of(shard) && shard.index < shard.count ? std::optional(shard) : std::nullopt;
}

std::uint64_t length_of(ProcessArguments whole) {
    whole.keep_going = false;  // as the ranges
    const auto infos = infos_of(whole);
    if (infos.size() > 1) {
        throw std::invalid_argument("--split: " + whole.source +
                                    " has images of several sizes or calibrations, allowed: those of one");
    }
    const std::optional<std::uint64_t> frames = infos.empty() ? std::nullopt : infos.front().frame_count;
    if (!frames || *frames > most_frames) {
        throw std::invalid_argument("--split: how many frames " + whole.source +
                                    " has is not known, allowed: images, recordings and videos that tell it; without "
                                    "--split a shard takes whole sources");
    }
    return *frames;
}

void check_folder(const ProcessArguments& whole, Shard shard) {
    for (const Shard& found : ranges_in(whole.folder)) {
        if (found.count != shard.count) {
            throw std::invalid_argument(whole.folder + ": holds " + name_of(found) + ", allowed with --shard " +
                                        whole.shard + ": ranges of " + std::to_string(shard.count) +
                                        " shards; go on with as many shards as before, or remove that folder");
        }
    }
    FolderContent found = content_of(whole.folder);
    found.range.clear();
    check_content(whole.folder, found, replacing(whole));
}

}  // namespace

std::vector<ShardRange> ranges_of(const std::string& folder, std::uint64_t frames, std::size_t shards) {
    std::vector<ShardRange> ranges;
    for (std::size_t i = 0; i < shards; ++i) {
        const std::uint64_t first = frames * i / shards, behind = frames * (i + 1) / shards;
        if (first < behind) {
            const bool last = i + 1 == shards;
            ranges.push_back(
                {folder + '/' + name_of({i, shards}), first, last ? std::nullopt : std::optional(behind - first)});
        }
    }
    return ranges;
}

std::vector<Shard> ranges_in(const std::string& folder) {
    std::vector<Shard> ranges;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        const auto shard = shard_of_name(entry.path().filename().string());
        if (shard && base::is_folder(entry.path())) {
            ranges.push_back(*shard);
        }
    }
    return ranges;
}

std::vector<std::string> range_folders_in(const std::string& folder) {
    std::vector<std::string> folders;
    for (const Shard& shard : ranges_in(folder)) {
        folders.push_back(folder + '/' + name_of(shard));
    }
    return folders;
}

bool is_range(const std::string& name) {
    return shard_of_name(name).has_value();
}

ProcessArguments SplitSource::arguments(ProcessArguments whole) const {
    whole.folder = mine.folder;
    whole.first = static_cast<int>(mine.first);
    whole.frames = mine.count ? std::optional(static_cast<int>(*mine.count)) : std::nullopt;
    whole.whole_frames = frames;
    whole.keep_going = false;
    return whole;
}

std::optional<SplitSource> split_source(const ProcessArguments& whole, Shard shard) {
    check_folder(whole, shard);
    SplitSource split{whole.folder, length_of(whole), {}, {}};
    split.ranges = ranges_of(whole.folder, split.frames, shard.count);
    const std::string own = whole.folder + '/' + name_of(shard);
    const auto mine = std::find_if(split.ranges.begin(), split.ranges.end(),
                                   [&own](const ShardRange& range) { return range.folder == own; });
    if (mine == split.ranges.end()) {
        return std::nullopt;
    }
    split.mine = *mine;
    return split;
}

}  // namespace disparityd::tools
