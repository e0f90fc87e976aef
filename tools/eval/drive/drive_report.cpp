// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/drive/drive_report.h"

#include <algorithm>
#include <cstddef>
#include <iostream>
#include <stdexcept>

#include "base/number_text.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/eval/drive/drive_picture.h"
#include "tools/eval/drive/true_sight.h"
#include "tools/eval/scan/percent_text.h"
#include "tools/eval/seed_argument.h"

namespace disparityd::eval {
namespace {

/// One ray a pixel: four would take a drive three times as long. Edges are harder than a camera's.
CourseCamera drive_camera() {
    CourseCamera camera;
    camera.rays = 1;
    return camera;
}

/// Adds what "noise" or "all" name at each strength, and "noise:low" at that one.
void add_named(std::vector<ConditionAt>& rows, std::string name) {
    std::vector<Strength> strengths(all_strengths.begin(), all_strengths.end());
    const std::size_t colon = name.rfind(':');
    if (colon != std::string::npos) {
        const std::string wanted = name.substr(colon + 1);
        std::erase_if(strengths, [&](Strength strength) { return to_string(strength) != wanted; });
        if (strengths.empty()) {
            throw std::invalid_argument("--condition: found the strength '" + wanted + "', allowed: low, middle, high");
        }
        name.resize(colon);
    }
    for (const Condition* condition :
         conditions_named(name == "all" ? std::vector<std::string>{} : std::vector{name})) {
        for (const Strength strength : strengths) {
            rows.push_back({condition, strength});
        }
    }
}

std::vector<ConditionAt> conditions_of(const std::vector<std::string>& names) {
    std::vector<ConditionAt> rows{{}};
    for (const std::string& name : names) {
        add_named(rows, name);
    }
    return rows;
}

std::string title(const ConditionAt& at) {
    return at.condition == nullptr ? "clean" : std::string(at.condition->name);
}

std::string strength_of(const ConditionAt& at) {
    return at.condition == nullptr ? "" : strength_text(*at.condition, at.strength);
}

std::vector<std::string> line(const ConditionAt& at, const DriveCounts& counts) {
    const double share = counts.true_speed() > 0 ? counts.speed() / counts.true_speed() : 0;
    return {title(at),
            strength_of(at),
            std::to_string(counts.courses),
            std::to_string(counts.collisions),
            std::to_string(counts.reached),
            tools::fixed(counts.speed(), 2),
            percent(share, counts.true_speed() > 0 ? 1 : 0, 0),
            tools::fixed(static_cast<double>(counts.stops) / std::max(counts.courses, 1), 1),
            std::to_string(counts.true_collisions),
            std::to_string(counts.true_reached),
            tools::fixed(counts.true_speed(), 2)};
}

DriveRules rules_of(const DriveEvaluation& evaluation) {
    DriveRules rules;
    rules.keep_the_track = !evaluation.pictures.empty();
    return rules;
}

DriveResult perfect_drive(const Course& course, const DriveEvaluation& evaluation) {
    return drive(course, evaluation.robot, rules_of(evaluation),
                 true_sight(course, drive_camera(), evaluation.settings));
}

/// The sums of one condition over all courses.
DriveCounts counts_of(const ConditionAt& at, const std::vector<Course>& courses, const DriveEvaluation& evaluation,
                      const std::vector<DriveResult>& perfect, Parallel& workers) {
    std::vector<DriveCounts> drives(courses.size());
    workers.for_each(static_cast<int>(courses.size()), [&](int i) {
        const auto one = static_cast<std::size_t>(i);
        drives[one] = count_drive(courses[one], at, evaluation, perfect[one]);
    });
    DriveCounts all;
    for (const DriveCounts& one : drives) {
        all.add(one);
    }
    return all;
}

}  // namespace

void DriveCounts::add(const DriveCounts& other) {
    courses += other.courses;
    collisions += other.collisions;
    reached += other.reached;
    stops += other.stops;
    gone_m += other.gone_m;
    seconds += other.seconds;
    true_gone_m += other.true_gone_m;
    true_seconds += other.true_seconds;
    true_reached += other.true_reached;
    true_collisions += other.true_collisions;
    collided.insert(collided.end(), other.collided.begin(), other.collided.end());
}

std::optional<std::uint32_t> seed_of_drives(const std::vector<std::string>& data) {
    return seed_argument("--scan", "drive", data);
}

DriveCounts count_drive(const Course& course, const ConditionAt& at, const DriveEvaluation& evaluation) {
    return count_drive(course, at, evaluation, perfect_drive(course, evaluation));
}

DriveCounts count_drive(const Course& course, const ConditionAt& at, const DriveEvaluation& evaluation,
                        const DriveResult& perfect_as_it_is) {
    const Course there = course_in(course, at);
    const DriveRules rules = rules_of(evaluation);
    const Robot& robot = evaluation.robot;
    const DriveResult real =
        drive(there, robot, rules, matched_sight(there, at, drive_camera(), evaluation.settings, robot.frames_per_s));
    const DriveResult perfect =
        there.obstacles == course.obstacles ? perfect_as_it_is : perfect_drive(there, evaluation);
    DriveCounts counts;
    counts.courses = 1;
    counts.collisions = real.collided ? 1 : 0;
    counts.reached = real.reached ? 1 : 0;
    counts.stops = real.stops;
    counts.gone_m = real.gone_m;
    counts.seconds = real.seconds;
    counts.true_gone_m = perfect.gone_m;
    counts.true_seconds = perfect.seconds;
    counts.true_reached = perfect.reached ? 1 : 0;
    counts.true_collisions = perfect.collided ? 1 : 0;
    if (real.collided) {
        counts.collided.push_back(title(at) + ' ' + strength_of(at) + ", seed " + std::to_string(course.seed) +
                                  ": collided after " + base::fixed(real.seconds, 1) + " s, " +
                                  base::fixed(real.gone_m, 2) + " m ahead" +
                                  (perfect.collided ? "; with perfect depth, too" : ""));
    }
    if (rules.keep_the_track && at.condition == nullptr) {
        write_drive_picture(evaluation.pictures + "/drive-" + std::to_string(course.seed) + ".png", there, robot, rules,
                            {real, perfect});
    }
    return counts;
}

void report_drives(const DriveEvaluation& evaluation, Parallel& workers, bool markdown) {
    const std::vector<ConditionAt> rows = conditions_of(evaluation.names);
    const std::vector<Course> courses = make_base_courses(evaluation.seed, evaluation.courses);
    tools::Table table({"condition", "strength", "courses", "collisions", "reached", "m/s", "% of perfect",
                        "stops each", "perfect depth: collisions", "reached", "m/s"});
    std::vector<DriveResult> perfect(courses.size());
    workers.for_each(static_cast<int>(courses.size()), [&](int i) {
        const auto one = static_cast<std::size_t>(i);
        perfect[one] = perfect_drive(courses[one], evaluation);
    });
    std::vector<std::string> collided;
    tools::Progress progress("conditions", rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const ConditionAt& at = rows[i];
        progress.show(i, title(at) + ' ' + strength_of(at));
        const DriveCounts counts = counts_of(at, courses, evaluation, perfect, workers);
        table.add(line(at, counts));
        collided.insert(collided.end(), counts.collided.begin(), counts.collided.end());
    }
    markdown ? table.print_markdown(std::cout) : table.print(std::cout);
    for (const std::string& one : collided) {
        std::cout << one << '\n';
    }
}

}  // namespace disparityd::eval
