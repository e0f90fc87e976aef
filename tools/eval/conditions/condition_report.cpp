// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/conditions/condition_report.h"

#include <algorithm>
#include <cstddef>
#include <iostream>

#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/eval/conditions/condition.h"
#include "tools/eval/conditions/condition_sheet.h"
#include "tools/eval/conditions/course_in_conditions.h"
#include "tools/eval/scan/percent_text.h"
#include "tools/eval/scan/scan_judgement.h"

namespace disparityd::eval {
namespace {

struct Row {
    ScanCounts counts;
    double density = 0;  ///< sum over the courses

    void add(const Row& other) {
        counts.add(other.counts);
        density += other.density;
    }
    double shown() const {
        return counts.obstacles > 0 ? 1 - static_cast<double>(counts.missed) / counts.obstacles : 0;
    }
    double free() const { return counts.free_share / std::max(counts.sectors, 1); }
};

/// The rows of one course: as it is, then each condition at each strength.
std::vector<Row> rows_of(const Course& course, const ConditionEvaluation& evaluation,
                         const std::vector<const Condition*>& chosen) {
    const CourseCamera camera;
    Serial serial;
    CourseScanner scanner(evaluation.settings, camera, serial);
    const auto judged = [&](const Taken& taken) {
        const Scan& scan = scanner.scan(taken.images[0], taken.images[1], false);
        return Row{judge(scan, evaluation.settings.scan, taken.truth->view(), taken.truth->course, camera,
                         evaluation.settings.match.range.count),
                   scanner.density()};
    };
    const CourseInConditions in_conditions(course, camera);
    std::vector<Row> rows{judged(in_conditions.clean())};
    for (const Condition* condition : chosen) {
        for (const Strength strength : all_strengths) {
            rows.push_back(judged(in_conditions.in(*condition, strength)));
        }
    }
    return rows;
}

std::vector<Row> rows_of_all(const ConditionEvaluation& evaluation, const std::vector<const Condition*>& chosen,
                             Parallel& workers) {
    const std::vector<Course> courses = make_base_courses(evaluation.seed, evaluation.courses);
    std::vector<Row> sums(1 + all_strengths.size() * chosen.size());
    tools::Progress progress("courses", courses.size());
    const auto at_once = static_cast<std::size_t>(workers.workers());
    for (std::size_t first = 0; first < courses.size(); first += at_once) {
        progress.show(first);
        std::vector<std::vector<Row>> rows(std::min(at_once, courses.size() - first));
        workers.for_each(static_cast<int>(rows.size()), [&](int i) {
            const auto one = static_cast<std::size_t>(i);
            rows[one] = rows_of(courses[first + one], evaluation, chosen);
        });
        for (const std::vector<Row>& of_one : rows) {
            for (std::size_t i = 0; i < sums.size(); ++i) {
                sums[i].add(of_one[i]);
            }
        }
    }
    return sums;
}

std::vector<std::string> line(const std::string& name, const std::string& strength, const Row& row, const Row& clean) {
    const ScanCounts& counts = row.counts;
    return {name,
            strength,
            std::to_string(counts.obstacles),
            std::to_string(counts.missed),
            std::to_string(counts.near),
            std::to_string(counts.declared_free + counts.near_free),
            tools::fixed(1000.0 * counts.false_alarms / std::max(counts.sectors, 1), 1),
            percent(row.shown(), clean.shown(), 1),
            percent(row.free(), clean.free(), 1),
            percent(row.density, counts.courses, 1)};
}

}  // namespace

void report_conditions(const ConditionEvaluation& evaluation, Parallel& workers, bool markdown) {
    const std::vector<const Condition*> chosen = conditions_named(evaluation.names);
    if (!evaluation.pictures.empty()) {
        write_condition_sheets(chosen, make_base_courses(evaluation.seed, 1).front(), evaluation.pictures);
    }
    const std::vector<Row> rows = rows_of_all(evaluation, chosen, workers);
    tools::Table table({"condition", "strength", "obstacles", "missed", "too near", "said free", "false alarms in 1000",
                        "shown % of clean", "free % of clean", "density %"});
    table.add(line("clean", "", rows[0], rows[0]));
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
        const Condition& condition = *chosen[i / all_strengths.size()];
        const Strength strength = all_strengths[i % all_strengths.size()];
        table.add(line(std::string(condition.name), strength_text(condition, strength), rows[i + 1], rows[0]));
    }
    markdown ? table.print_markdown(std::cout) : table.print(std::cout);
}

}  // namespace disparityd::eval
