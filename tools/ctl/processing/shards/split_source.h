// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/ctl/processing/process_arguments.h"
#include "tools/ctl/processing/shards/source_list.h"

namespace disparityd::tools {

/// The frames of a source that --split gives to one shard.
struct ShardRange {
    std::string folder;  ///< FOLDER/range-I-of-N, where FOLDER is that of the source
    std::uint64_t first = 0;
    std::optional<std::uint64_t> count;  ///< nothing: all behind it, as a length may be told as too small
};

/// Cuts a source of so many frames: shard I of N gets the frames from I * frames / N to (I + 1) * frames / N - 1, both
/// rounded down. Shards without a frame are left out.
std::vector<ShardRange> ranges_of(const std::string& folder, std::uint64_t frames, std::size_t shards);

/// Returns the ranges of --split that have a folder in `folder`, finished or not; nothing where it is not there.
std::vector<Shard> ranges_in(const std::string& folder);

/// The same as folders.
std::vector<std::string> range_folders_in(const std::string& folder);

/// Whether a folder's name is that of a range.
bool is_range(const std::string& name);

/// A source that --split cuts, and which of its ranges is to be done.
struct SplitSource {
    std::string folder;              ///< of the whole
    std::uint64_t frames = 0;        ///< of the whole
    std::vector<ShardRange> ranges;  ///< of all shards
    ShardRange mine;                 ///< one of them

    /// Returns the arguments for the own range, of those for the whole. An image that cannot be read ends the range,
    /// also with --keep-going: ranges are counted by the images that are there.
    ProcessArguments arguments(ProcessArguments whole) const;
};

/// Opens the source for its length and cuts it. Nothing: no frame of it belongs to the shard. Throws
/// std::invalid_argument where the length is not known, where a folder holds ranges for another number of shards, or
/// anything else that may not be replaced; also as infos_of().
std::optional<SplitSource> split_source(const ProcessArguments& whole, Shard shard);

}  // namespace disparityd::tools
