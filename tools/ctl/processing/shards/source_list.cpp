// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/shards/source_list.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <utility>

#include "base/failure_text.h"
#include "base/file_kind.h"
#include "capture/images/image_sequence.h"
#include "tools/ctl/processing/process_output.h"

namespace disparityd::tools {
namespace {

namespace fs = std::filesystem;

/// Whether the word names both eyes.
bool stands_alone(const std::string& word) {
    if (!capture::is_image_sequence(word)) {
        return true;
    }
    if (!base::is_folder(word)) {
        return false;
    }
    try {
        capture::find_images(word);
        return true;
    } catch (const std::invalid_argument&) {
        return false;  // a folder of one eye
    }
}

/// Returns the file or folder that a source begins with, as an absolute path; of other sources the whole text.
fs::path place_of(const std::string& uri) {
    fs::path path = uri;
    std::error_code too_long;  // a pipeline of GStreamer may be longer than a name can be
    for (const char* const rest : {"?", ","}) {
        if (!fs::exists(path, too_long)) {
            path = uri.substr(0, uri.find(rest));
        }
    }
    const bool is_file = fs::exists(path, too_long) || uri.find(':') == std::string::npos;
    if (!is_file) {
        std::string text = uri;
        std::replace(text.begin(), text.end(), '/', '_');
        return text;
    }
    path = fs::absolute(path).lexically_normal();
    return path.has_filename() ? path : path.parent_path();  // "walk/"
}

/// Level 0: the name without its ending, 1: with it, 2: with a folder in front, and so on.
std::string name_of(const fs::path& place, std::size_t level) {
    std::string name = place.filename().string();
    fs::path above = place.parent_path();
    for (std::size_t i = 2; i <= level && above.has_filename(); ++i, above = above.parent_path()) {
        name.insert(0, above.filename().string() + '_');
    }
    const bool ends = level == 0 && !base::is_folder(place);
    return file_name(name, ends);
}

void check_once(const std::vector<std::string>& words) {
    std::map<std::string, int> times;
    for (const std::string& word : words) {
        if (++times[word] > 1) {
            throw std::invalid_argument(word + ": this source is named twice, allowed: once");
        }
    }
}

}  // namespace

std::vector<std::string> lines_of(const std::string& file) {
    std::ifstream text(file);
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) {
        if (!line.empty()) {
            lines.push_back(line);
        }
    }
    if (!text.eof()) {
        throw std::invalid_argument("--list: " + file + ": cannot be read: " + base::error_text(errno));
    }
    return lines;
}

std::vector<ListedSource> list_sources(const std::vector<std::string>& words, const std::string& folder) {
    if (words.size() == 1) {
        return {{words[0], folder}};
    }
    const std::string pair = words.size() == 2 ? words[0] + ',' + words[1] : std::string();
    if (!pair.empty() && !stands_alone(words[0]) && capture::is_image_sequence(pair)) {
        return {{pair, folder}};
    }
    check_once(words);
    std::vector<fs::path> places;
    std::transform(words.begin(), words.end(), std::back_inserter(places), place_of);
    std::vector<std::size_t> levels(words.size());
    constexpr std::size_t most_levels = 64;
    for (;;) {
        std::map<std::string, std::vector<std::size_t>> named;
        for (std::size_t i = 0; i < words.size(); ++i) {
            named[name_of(places[i], levels[i])].push_back(i);
        }
        bool differ = true;
        for (const auto& [name, same] : named) {
            if (same.size() > 1 && levels[same[0]] == most_levels) {
                throw std::invalid_argument(words[same[0]] + " and " + words[same[1]] + ": both would fill " + folder +
                                            '/' + name + "; process them one at a time, into different folders");
            }
            for (const std::size_t i : same) {
                levels[i] += same.size() > 1 ? 1U : 0U;
            }
            differ = differ && same.size() == 1;
        }
        if (differ) {
            break;
        }
    }
    std::vector<ListedSource> sources;
    for (std::size_t i = 0; i < words.size(); ++i) {
        sources.push_back({words[i], folder + '/' + name_of(places[i], levels[i])});
    }
    return sources;
}

Shard parse_shard(const std::string& text) {
    Shard shard;
    if (text.empty()) {
        return shard;
    }
    const char* const end = text.data() + text.size();
    const auto [slash, error] = std::from_chars(text.data(), end, shard.index);
    const bool first = error == std::errc() && slash != end && *slash == '/';
    const auto [stop, second] =
        first ? std::from_chars(slash + 1, end, shard.count) : std::from_chars_result{slash, error};
    if (!first || second != std::errc() || stop != end || shard.index >= shard.count) {
        throw std::invalid_argument("--shard: found '" + text +
                                    "', allowed: I/N, where I is 0 to N - 1, such as 0/8 to 7/8");
    }
    return shard;
}

std::vector<ListedSource> in_order(std::vector<ListedSource> sources) {
    std::sort(sources.begin(), sources.end(), [](const auto& a, const auto& b) { return a.uri < b.uri; });
    return sources;
}

std::vector<ListedSource> shard_of(std::vector<ListedSource> sources, const std::string& shard) {
    if (shard.empty()) {
        return sources;
    }
    const auto [index, count] = parse_shard(shard);
    sources = in_order(std::move(sources));
    std::vector<ListedSource> mine;
    for (std::size_t i = index; i < sources.size(); i += count) {
        mine.push_back(sources[i]);
    }
    return mine;
}

}  // namespace disparityd::tools
