// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/shards/plan.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/failure_text.h"
#include "base/words.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/program.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/processing/process_source.h"

namespace disparityd::tools {
namespace {

constexpr std::size_t most_measured = 3;
constexpr int measured_frames = 12;

/// A folder for temporary files, which goes with the object.
class TemporaryFolder {
public:
    TemporaryFolder() : path_((std::filesystem::temp_directory_path() / "disparityctl-plan-XXXXXX").string()) {
        if (::mkdtemp(path_.data()) == nullptr) {
            throw std::runtime_error(path_ + ": cannot be made: " + base::error_text(errno));
        }
    }
    ~TemporaryFolder() {
        std::error_code error;
        std::filesystem::remove_all(path_, error);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::string& path() const { return path_; }

private:
    std::string path_;
};

/// What a source has to do.
struct Planned {
    std::string uri;
    std::optional<std::uint64_t> frames;  ///< nothing: not known
    double megapixels = 0;                ///< of all frames that are known
};

/// What was measured.
struct Measured {
    std::vector<std::string> sources;
    std::uint64_t frames = 0;
    double seconds = 0;
    double megapixels = 0;
};

/// Pixels of a frame, to which its time is about proportional.
double megapixels_of(const ProcessArguments& arguments, const capture::SourceInfo& info) {
    const calibration::RectifiedGeometry size = geometry_of(arguments);
    const int width = size.width > 0 ? size.width : info.eye_width,
              height = size.height > 0 ? size.height : info.height;
    return static_cast<double>(width) * height / 1e6;
}

Planned planned(const ProcessArguments& arguments) {
    Planned all{arguments.source, 0, 0};
    for (const capture::SourceInfo& part : infos_of(arguments)) {
        if (!part.frame_count) {
            return {arguments.source, std::nullopt, 0};
        }
        *all.frames += *part.frame_count;
        all.megapixels += static_cast<double>(*part.frame_count) * megapixels_of(arguments, part);
    }
    return all;
}

/// Processes some frames of a source.
void measure(ProcessArguments arguments, pipeline::WorkerPool& workers, Measured& measured) {
    const TemporaryFolder folder;
    arguments.folder = folder.path();
    arguments.scan = arguments.scan.empty() ? "" : folder.path() + "/scan.csv";
    arguments.frames = std::min(arguments.frames.value_or(measured_frames), measured_frames);
    arguments.hash_inputs = false;  // it reads whole recordings
    const ProcessDone done = process_source(arguments, workers, {"measured", {}});
    if (!done.error.empty()) {
        throw std::runtime_error(done.error);
    }
    const Planned part = planned(arguments);
    measured.sources.push_back(arguments.source);
    measured.frames += done.frames;
    measured.seconds += done.seconds;
    measured.megapixels += part.frames ? part.megapixels : 0;
}

/// A number of shards, and how long the one with most to do takes.
struct Division {
    std::size_t shards = 0;
    double longest_s = 0;
};

struct Plan {
    std::vector<Planned> sources;  ///< that can be opened
    std::vector<std::string> unknown, failed;
    std::uint64_t frames = 0;
    Measured measured;
    std::vector<Division> divisions;  ///< empty: nothing was measured
};

/// With --split each shard gets its part of every source.
std::vector<Division> divisions_of_frames(const Plan& plan, double seconds_per_megapixel) {
    constexpr std::size_t most_shards = 64;
    double seconds = 0;
    for (const Planned& source : plan.sources) {
        seconds += source.megapixels * seconds_per_megapixel;
    }
    std::vector<Division> all;
    for (std::size_t shards = 1; shards <= std::min<std::uint64_t>(most_shards, plan.frames); shards *= 2) {
        all.push_back({shards, seconds / static_cast<double>(shards)});
    }
    return all;
}

/// Sources go to shards as shard_of() has them: `sources` are in the order of the bytes of their names.
std::vector<Division> divisions(const std::vector<Planned>& sources, double seconds_per_megapixel) {
    std::vector<Division> all;
    const auto add = [&](std::size_t shards) {
        std::vector<double> seconds(shards);
        for (std::size_t i = 0; i < sources.size(); ++i) {
            seconds[i % shards] += sources[i].megapixels * seconds_per_megapixel;
        }
        all.push_back({shards, *std::max_element(seconds.begin(), seconds.end())});
    };
    for (std::size_t shards = 1; shards < sources.size(); shards *= 2) {
        add(shards);
    }
    add(sources.size());
    return all;
}

Json plan_json(const Plan& plan) {
    Json divided = Json::array();
    for (const Division& one : plan.divisions) {
        divided.push_back({{"shards", one.shards}, {"longest_seconds", one.longest_s}});
    }
    return {
        {"sources", plan.sources.size()},
        {"frames", plan.frames},
        {"unknown_length", plan.unknown},
        {"failed", plan.failed},
        {"measured",
         {{"sources", plan.measured.sources}, {"frames", plan.measured.frames}, {"seconds", plan.measured.seconds}}},
        {"shards", divided}};
}

void print_plan(const Plan& plan) {
    std::cout << base::counted(plan.sources.size(), "source") << ", " << base::counted(plan.frames, "frame") << '\n';
    if (!plan.unknown.empty()) {
        std::cout << "not in it, as their length is not known: " << base::counted(plan.unknown.size(), "source")
                  << '\n';
        for (const std::string& uri : plan.unknown) {
            std::cout << "  " << uri << '\n';
        }
    }
    if (plan.divisions.empty()) {
        std::cout << "how long they take is not known: no frame could be measured\n";
        return;
    }
    const Measured& measured = plan.measured;
    std::cout << "measured on this machine: " << base::counted(measured.frames, "frame") << " of "
              << base::counted(measured.sources.size(), "source") << " in " << fixed(measured.seconds, 2) << " s, "
              << fixed(static_cast<double>(measured.frames) / measured.seconds, 1)
              << " frames/s; the rest is estimated by its pixels\n";
    Table table({"shards", "minutes of the longest"});
    for (const Division& one : plan.divisions) {
        table.add({std::to_string(one.shards), fixed(one.longest_s / 60, 1)});
    }
    table.print(std::cout);
}

}  // namespace

int plan(const ProcessArguments& arguments, const std::vector<ListedSource>& sources, pipeline::WorkerPool& workers) {
    Plan plan;
    ProcessArguments one = arguments;
    Progress bar("sources", sources.size());
    for (const ListedSource& source : in_order(sources)) {
        if (interrupted()) {
            break;
        }
        bar.show(plan.sources.size() + plan.failed.size());
        one.source = source.uri;
        try {
            const Planned length = planned(one);
            if (plan.measured.sources.size() < most_measured) {
                measure(one, workers, plan.measured);
            }
            plan.sources.push_back(length);
        } catch (const std::exception& error) {
            print_error(base::failure_text(error));
            plan.failed.push_back(source.uri);
            continue;
        }
        const std::optional<std::uint64_t> frames = plan.sources.back().frames;
        plan.frames += frames.value_or(0);
        if (!frames) {
            plan.unknown.push_back(source.uri);
        }
    }
    if (interrupted()) {  // what was measured may be cut short
        print_note("stopped by " + interrupted_by() + "; nothing was planned");
        return exit_interrupted;
    }
    if (plan.measured.megapixels > 0) {
        const double each = plan.measured.seconds / plan.measured.megapixels;
        plan.divisions = arguments.split ? divisions_of_frames(plan, each) : divisions(plan.sources, each);
    }
    if (arguments.json) {
        std::cout << to_text(plan_json(plan), 2) << '\n';
    } else {
        print_plan(plan);
    }
    return plan.failed.empty() ? exit_done : exit_failed;
}

}  // namespace disparityd::tools
