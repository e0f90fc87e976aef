// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/benchmark/benchmark.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <ostream>
#include <set>
#include <stdexcept>

#include "base/message_text.h"
#include "base/words.h"
#include "tools/command_line/program.h"
#include "tools/command_line/progress.h"
#include "tools/eval/benchmark/error_page.h"
#include "tools/images/fill_holes.h"

namespace disparityd::eval {
namespace {

/// Counts what cannot be judged, after a line for each.
class Problems {
public:
    explicit Problems(bool allowed) : allowed_(allowed) {}

    void tell(const std::string& line) {
        tools::print_note(line);
        ++count_;
    }

    /// Throws where there were any and none is allowed.
    void check() const {
        if (count_ > 0 && !allowed_) {
            throw std::invalid_argument(base::counted(count_, "result") +
                                        " cannot be judged, as told above: correct this, or judge the others with "
                                        "--incomplete");
        }
    }

private:
    bool allowed_;
    std::size_t count_ = 0;
};

/// Files of one matcher on one scene.
struct FilesOfScene {
    std::string matcher;
    std::string disparity;
    std::string confidence;  ///< empty = there is none
};

const ResultFiles* confidence_of(const BenchmarkRequest& request, const std::string& matcher) {
    const auto found = std::find_if(request.confidences.begin(), request.confidences.end(),
                                    [&](const ResultFiles& one) { return one.matcher == matcher; });
    return found == request.confidences.end() ? nullptr : &*found;
}

/// Refuses a file that is the ground truth itself, which would be perfect: submissions lie beside it by custom.
std::string checked_result(const std::string& path, const ResultFiles& result, const SceneToJudge& scene) {
    for (const std::string& truth : scene.truths) {
        if (std::error_code no_file; std::filesystem::equivalent(path, truth, no_file)) {
            throw std::invalid_argument(scene.name + ": " + result.matcher + " has " + base::printable(path, 300) +
                                        ", which is the ground truth; say by a pattern which file is the result");
        }
    }
    return path;
}

void check_names(const BenchmarkRequest& request) {
    std::set<std::string> names;
    for (const SceneToJudge& scene : request.scenes) {
        if (!names.insert(scene.name).second) {
            throw std::invalid_argument(scene.name +
                                        ": two scenes have this name; judge the folders that hold them one by one");
        }
    }
    std::set<std::string> matchers;
    for (const ResultFiles& files : request.results) {
        if (!matchers.insert(files.matcher).second) {
            throw std::invalid_argument("--results: two have the name '" + files.matcher + "'; allowed: NAME=WHERE");
        }
    }
    for (const ResultFiles& files : request.confidences) {
        if (matchers.count(files.matcher) == 0) {
            throw std::invalid_argument("--confidences: no --results have the name '" + files.matcher + "'");
        }
    }
}

class Benchmark {
public:
    explicit Benchmark(const BenchmarkRequest& request) : request_(request), problems_(request.incomplete) {
        check_names(request);
        if (!request.page.empty()) {
            page_.emplace(request.page);
        }
    }

    void run(std::ostream& to) {
        const std::vector<std::vector<FilesOfScene>> files = find_files();
        tools::Progress progress("scenes", request_.scenes.size());
        for (std::size_t i = 0; i < request_.scenes.size(); ++i) {
            progress.show(i, request_.scenes[i].name);
            judge(request_.scenes[i], files[i]);
        }
        problems_.check();
        if (cells_.empty()) {
            throw std::invalid_argument("nothing is left to judge: each result is missing or cannot be read");
        }
        print_benchmark(cells_, request_.holes, request_.format, to);
        if (page_) {
            page_->write(request_.holes);
        }
    }

private:
    /// Every file of every scene, before the first is opened.
    std::vector<std::vector<FilesOfScene>> find_files() {
        std::vector<std::vector<FilesOfScene>> all;
        for (const SceneToJudge& scene : request_.scenes) {
            std::vector<FilesOfScene>& of_scene = all.emplace_back();
            for (const ResultFiles& result : request_.results) {
                try {
                    FilesOfScene files{result.matcher, checked_result(find_result(result, scene.name), result, scene),
                                       ""};
                    if (const ResultFiles* confidence = confidence_of(request_, result.matcher)) {
                        files.confidence = find_result(*confidence, scene.name);
                    }
                    of_scene.push_back(std::move(files));
                } catch (const std::invalid_argument& missing) {
                    problems_.tell(missing.what());
                }
            }
        }
        problems_.check();
        return all;
    }

    void judge(const SceneToJudge& to_judge, const std::vector<FilesOfScene>& files) {
        std::optional<Scene> scene;
        try {
            scene = to_judge.read();
        } catch (const std::invalid_argument& damaged) {
            problems_.tell(damaged.what());
            return;
        }
        const std::vector<RegionMask> regions = chosen_regions(*scene);
        for (const FilesOfScene& one : files) {
            try {
                JudgedMap map{read_result(one.disparity, scene->truth.width, scene->truth.height), {}};
                if (!one.confidence.empty()) {
                    map.confidence = read_confidence(one.confidence, scene->truth.width, scene->truth.height);
                }
                add(*scene, one.matcher, map, regions);
            } catch (const std::invalid_argument& damaged) {
                problems_.tell(to_judge.name + ": " + damaged.what());
            }
        }
        if (request_.match) {
            for (const NamedMap& made : request_.match(*scene, to_judge.disparities)) {
                check_name_of(made);
                add(*scene, made.matcher, made.map, regions);
            }
        }
    }

    void check_name_of(const NamedMap& made) const {
        for (const ResultFiles& files : request_.results) {
            if (files.matcher == made.matcher) {
                throw std::invalid_argument("--results: the name '" + files.matcher +
                                            "' is that of a matcher that runs here; choose another");
            }
        }
    }

    std::vector<RegionMask> chosen_regions(const Scene& scene) const {
        std::vector<RegionMask> regions = regions_of(scene);
        std::erase_if(regions, [this](const RegionMask& mask) {
            return !request_.regions.empty() &&
                   std::find(request_.regions.begin(), request_.regions.end(), mask.region) == request_.regions.end();
        });
        if (regions.empty()) {
            tools::print_note(scene.name + ": none of the regions that were asked for is known of it");
        }
        return regions;
    }

    void add(const Scene& scene, const std::string& matcher, const JudgedMap& map,
             const std::vector<RegionMask>& regions) {
        std::optional<images::FloatMap> filled;
        if (request_.holes == Holes::filled) {
            filled = images::fill_from_background(map.disparity);
        }
        const images::FloatMap& judged = filled ? *filled : map.disparity;
        std::vector<BenchmarkCell> cells;
        cells.reserve(regions.size());
        for (const RegionMask& mask : regions) {
            cells.push_back(
                {scene.name, matcher, mask.region, tally(map, judged, scene.truth, mask.pixels, request_.holes)});
        }
        if (page_ && !cells.empty()) {
            page_->add(scene, judged, cells);
        }
        std::move(cells.begin(), cells.end(), std::back_inserter(cells_));
    }

    const BenchmarkRequest& request_;
    Problems problems_;
    std::optional<ErrorPage> page_;
    std::vector<BenchmarkCell> cells_;
};

}  // namespace

void run_benchmark(const BenchmarkRequest& request, std::ostream& to) {
    Benchmark(request).run(to);
}

}  // namespace disparityd::eval
