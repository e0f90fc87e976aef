// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace disparityd::tools {

/// A source of a list, and the folder that it fills.
struct ListedSource {
    std::string uri;
    std::string folder;
};

/// Returns the lines of a file but for empty ones. Throws std::invalid_argument when it cannot be read.
std::vector<std::string> lines_of(const std::string& file);

/// Returns the sources that the words name, each with its folder. One source fills `folder` itself; two words that are
/// the images of two eyes are one. Of several, each fills a folder in it of its own name: the file's without its
/// ending; where several have that name, with the ending, then with so many folders in front ("b_walk.mkv" of
/// b/walk.mkv) that they differ. Names do not depend on the order. Throws std::invalid_argument with one line where a
/// source is named twice, or names do not differ whatever is in front.
std::vector<ListedSource> list_sources(const std::vector<std::string>& words, const std::string& folder);

/// Shard `index` of so many, counted from 0.
struct Shard {
    std::size_t index = 0;
    std::size_t count = 1;
};

/// Reads "I/N"; empty text: the only one. Throws std::invalid_argument unless 0 <= I < N.
Shard parse_shard(const std::string& text);

/// Returns the sources in the order of the bytes of their names, which no shard takes from another one.
std::vector<ListedSource> in_order(std::vector<ListedSource> sources);

/// Returns those of shard "I/N": source k, counted from 0 in the order of the bytes of their names, belongs to shard
/// k mod N. Empty text: all. Throws std::invalid_argument unless 0 <= I < N.
std::vector<ListedSource> shard_of(std::vector<ListedSource> sources, const std::string& shard);

}  // namespace disparityd::tools
