// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/shards/join_ranges.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>

#include "base/failure_text.h"
#include "base/file_kind.h"
#include "tools/command_line/program.h"
#include "tools/ctl/growing_file.h"
#include "tools/ctl/processing/begun_run.h"
#include "tools/ctl/processing/digest.h"
#include "tools/ctl/processing/earlier_run.h"
#include "tools/ctl/processing/manifest.h"
#include "tools/ctl/processing/process_output.h"
#include "tools/ctl/processing/times_csv.h"

namespace disparityd::tools {
namespace {

namespace fs = std::filesystem;

bool all_finished(const std::vector<ShardRange>& ranges) {
    return std::all_of(ranges.begin(), ranges.end(),
                       [](const ShardRange& range) { return base::is_file(range.folder + '/' + manifest_name); });
}

/// Returns what all ranges of a source have in common.
Json common(const Json& manifest) {
    Json facts{{"version", manifest.at("made_by")},
               {"parameters", manifest.at("parameters")},
               {"parts", manifest.at("parts")},
               {"files", manifest.at("files")},
               {"input_sha256", manifest.value("input_sha256", Json())}};
    facts["files"].erase(corrections_name);
    return facts;
}

/// The manifest of a range without its frames, and how many these are.
struct RangeRun {
    Json manifest;
    std::uint64_t frames = 0;
};

/// Reads the manifest of a range. Its parameters become those of the whole.
RangeRun read_range(const ShardRange& range) {
    RangeRun run;
    run.manifest = read_manifest(range.folder, [&run](const Json&) { ++run.frames; });
    Json& parameters = run.manifest["parameters"];
    const Json first = range.first, frames = range.count ? Json(*range.count) : Json();
    if (parameters.value("first", Json()) != first || parameters.value("frames", Json()) != frames) {
        throw std::invalid_argument(range.folder +
                                    ": holds other frames than its name says; remove it, and let "
                                    "--resume make it again");
    }
    parameters["first"] = 0;
    parameters["frames"] = nullptr;
    return run;
}

/// Moves a file of a range, unless a join that was killed has done so.
void move_file(const std::string& from, const std::string& to, const std::string& name) {
    std::error_code error;
    fs::rename(from + '/' + name, to + '/' + name, error);
    if (error && !base::is_file(to + '/' + name)) {
        throw std::runtime_error(from + '/' + name + ": cannot be moved to " + to + ": " +
                                 base::error_text(error.value()) + "; --resume makes what is missing again");
    }
}

/// Waits for the process that has just finished the range: its manifest is there a moment before it lets go of the
/// folder. Throws as FolderLock where it does not.
std::unique_ptr<FolderLock> lock_finished(const std::string& folder) {
    constexpr std::chrono::milliseconds pause{50};
    const auto patience = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    for (;;) {
        try {
            return std::make_unique<FolderLock>(folder, FolderLock::Missing::leave);
        } catch (const std::runtime_error&) {
            if (std::chrono::steady_clock::now() > patience) {
                throw;
            }
        }
        std::this_thread::sleep_for(pause);
    }
}

[[noreturn]] void refuse_times(const ShardRange& range, const std::string& why) {
    throw std::invalid_argument(range.folder + '/' + times_name + ": is damaged: " + why + "; remove " + range.folder +
                                ", and let --resume make it again");
}

/// Returns a line of times.csv without the times of so many steps, which stand before the last column.
std::string without_steps(const std::string& line, std::ptrdiff_t steps) {
    std::size_t at = line.rfind(',');
    const std::string total = line.substr(at);
    for (std::ptrdiff_t i = 0; i < steps; ++i) {
        at = line.rfind(',', at - 1);
    }
    return line.substr(0, at) + total;
}

/// Writes times.csv of the whole. Two back ends have different steps: then their times are left out, the sum stays.
void join_times(const SplitSource& source, const std::vector<RangeRun>& runs) {
    std::vector<std::string> heads;
    for (const ShardRange& range : source.ranges) {
        std::ifstream file(range.folder + '/' + times_name);
        std::getline(file, heads.emplace_back());
    }
    const std::string known = times_head();
    const auto commas = [](const std::string& text) { return std::count(text.begin(), text.end(), ','); };
    const bool alike = std::all_of(heads.begin(), heads.end(), [&](const auto& head) { return head == heads[0]; });
    GrowingFile times(source.folder + '/' + times_name);
    for (std::size_t i = 0; i < source.ranges.size(); ++i) {
        const ShardRange& range = source.ranges[i];
        const std::ptrdiff_t columns = commas(heads[i]);
        if (columns < commas(known)) {
            refuse_times(range, "found another first line");
        }
        const std::ptrdiff_t left_out = alike ? 0 : columns - commas(known);
        const std::uint64_t frames = runs[i].frames;
        std::uint64_t lines = 0;
        std::ifstream file(range.folder + '/' + times_name);
        for (std::string line; std::getline(file, line); ++lines) {
            if (commas(line) != columns) {
                refuse_times(range, "line " + std::to_string(lines + 1) + " has other columns than the first");
            }
            if (lines > 0 || i == 0) {
                times.write(without_steps(line, left_out) + '\n');
            }
        }
        if (lines != frames + 1) {
            refuse_times(range, "found " + std::to_string(lines) + " lines for " + std::to_string(frames) + " frames");
        }
    }
    times.finish();
}

/// Writes corrections.csv of the whole where a range has one. Returns whether there is one.
bool join_corrections(const SplitSource& source) {
    std::optional<GrowingFile> corrections;
    for (const ShardRange& range : source.ranges) {
        std::ifstream file(range.folder + '/' + corrections_name);
        std::string head;
        if (!std::getline(file, head)) {
            continue;
        }
        if (!corrections) {
            corrections.emplace(source.folder + '/' + corrections_name);
            corrections->write(head + '\n');
        }
        for (std::string line; std::getline(file, line);) {
            corrections->write(line + '\n');
        }
    }
    if (corrections) {
        corrections->finish();
    }
    return corrections.has_value();
}

/// Throws where two ranges were not made with the same things.
void check_belongs(const ShardRange& range, const Json& manifest, const ShardRange& to, const Json& other) {
    const Json here = common(manifest), there = common(other);
    for (const auto& [key, value] : here.items()) {  // what explains the others is first
        const std::string found = difference({{key, value}}, {{key, there.at(key)}}, "there");
        if (!found.empty()) {
            throw std::invalid_argument(range.folder + ": does not belong to " + to.folder + ": " + found +
                                        "; remove the one that is wrong, and let --resume make it again");
        }
    }
}

/// Reads the manifests of all ranges. Throws where two do not belong together.
std::vector<RangeRun> read_ranges(const std::vector<ShardRange>& ranges) {
    std::vector<RangeRun> runs;
    for (const ShardRange& range : ranges) {
        runs.push_back(read_range(range));
        check_belongs(range, runs.back().manifest, ranges.front(), runs.front().manifest);
    }
    return runs;
}

/// What is in the folder must neither look finished nor stay where it was made with other things.
void clear_folder(const std::string& folder, const Json& parameters) {
    const auto before = begun_with(folder);
    if (before && *before != parameters) {
        remove_earlier_run(folder);
    }
    const std::string manifest = folder + '/' + manifest_name;
    if (base::is_file(manifest)) {
        fs::rename(manifest, GrowingFile::part_of(manifest));
    }
    remove_half_written(folder);
    fs::remove(folder + '/' + corrections_name);
}

/// Adds what tells the files of each frame of a run from others.
void add_frames(std::vector<std::size_t>& frames, const std::string& folder) {
    read_manifest(folder, [&frames](const Json& frame) {
        frames.push_back(std::hash<std::string>{}(frame.at("sha256").dump()));
    });
}

/// Returns how many frames the whole has where it was made of these ranges already: then they are only left over.
std::optional<std::uint64_t> joined_before(const SplitSource& source, const Json& first) {
    if (!base::is_file(source.folder + '/' + manifest_name) ||
        common(first) != common(read_manifest(source.folder, [](const Json&) {}))) {
        return std::nullopt;
    }
    std::vector<std::size_t> whole, parts;
    add_frames(whole, source.folder);
    for (const ShardRange& range : source.ranges) {
        add_frames(parts, range.folder);
    }
    return whole == parts ? std::optional<std::uint64_t>(whole.size()) : std::nullopt;
}

/// Moves the files of all frames and adds them to the manifest. Returns how many frames there are.
std::uint64_t move_frames(const SplitSource& source, ManifestWriter& whole) {
    std::uint64_t frames = 0;
    for (const ShardRange& range : source.ranges) {
        const auto lock = lock_finished(range.folder);  // nobody makes it anew meanwhile
        read_manifest(range.folder, [&](const Json& frame) {
            for (const auto& [name, digest] : frame.at("sha256").items()) {
                move_file(range.folder, source.folder, name);
            }
            whole.add(frame);
            ++frames;
        });
    }
    return frames;
}

/// Returns the losses of all ranges.
Json losses_of(const std::vector<RangeRun>& runs) {
    Json losses{{"damaged", 0}, {"left_out", Json::array()}, {"lost", 0}};
    for (const RangeRun& run : runs) {
        for (const char* const name : {"damaged", "lost"}) {
            losses[name] = losses[name].get<std::uint64_t>() + run.manifest.at("losses").at(name).get<std::uint64_t>();
        }
    }
    return losses;
}

std::uint64_t join(const SplitSource& source, const FolderLock& lock) {
    const std::vector<RangeRun> runs = read_ranges(source.ranges);
    const Json& first = runs.front().manifest;
    if (const auto frames = joined_before(source, first)) {
        return *frames;
    }
    clear_folder(source.folder, first["parameters"]);
    ManifestWriter whole(source.folder, first["parameters"]);
    join_times(source, runs);  // it names the files before they come
    const std::uint64_t frames = move_frames(source, whole);
    const bool corrected = join_corrections(source);
    Json files = common(first)["files"];
    for (const auto& [name, digest] : files.items()) {
        move_file(source.ranges.front().folder, source.folder, name);
    }
    if (corrected) {
        files[corrections_name] = sha256_of_file(source.folder + '/' + corrections_name);
    }
    lock.sync(source.folder);
    whole.finish({{"parts", first["parts"]},
                  {"losses", losses_of(runs)},
                  {"files", files},
                  {"scan_sha256", nullptr},
                  {"input_sha256", first.value("input_sha256", Json())}});
    return frames;
}

}  // namespace

std::optional<std::uint64_t> join_ranges(const SplitSource& source) {
    if (!all_finished(source.ranges)) {
        return std::nullopt;
    }
    std::optional<FolderLock> lock;
    try {
        lock.emplace(source.folder, FolderLock::Missing::leave);
    } catch (const std::runtime_error&) {
        return std::nullopt;  // another process joins them, and finishes what is begun
    }
    if (!all_finished(source.ranges)) {
        return std::nullopt;  // it has done so meanwhile
    }
    const std::uint64_t frames = join(source, *lock);
    remove_joined_ranges(source.folder);
    return frames;
}

void remove_joined_ranges(const std::string& folder) {
    for (const std::string& range : range_folders_in(folder)) {
        try {
            const FolderLock lock(range, FolderLock::Missing::leave);
            remove_earlier_run(range);
        } catch (const std::runtime_error&) {
            continue;  // another process holds it, and removes it
        }
        std::error_code kept;
        if (!fs::remove(range, kept) && kept) {
            print_note(range + ": is not needed any more; it stays, as there are other files in it");
        }
    }
}

}  // namespace disparityd::tools
