// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/line_up.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <stdexcept>

#include "tools/command_line/interrupt.h"
#include "tools/command_line/program.h"

namespace disparityd::bench {
namespace {

constexpr std::array methods = {Method::sgm, Method::sad, Method::census};

/// Pairs with more candidates keep naive code busy for seconds per frame.
constexpr double max_candidates_for_naive = 25e6;

bool names(const std::string& word, const std::string& contestant) {
    return contestant == word || contestant.rfind(word + '/', 0) == 0;
}

bool wanted(const Selection& selection, const std::string& contestant) {
    return selection.contestants.empty() ||
           std::any_of(selection.contestants.begin(), selection.contestants.end(),
                       [&](const std::string& word) { return names(word, contestant); });
}

std::string list_of(const std::vector<std::string>& words) {
    std::string list;
    for (const std::string& word : words) {
        list += (list.empty() ? "" : ", ") + word;
    }
    return list;
}

/// The fastest back end, where it is there.
bool has_gpu() {
    return backend("auto").name == "cuda";
}

/// Makes contestants one after the other.
class LineUp {
public:
    LineUp(const StereoPair& pair, const Selection& selection, const std::map<std::string, MatchOptions>& options_of,
           WorkerPools& pools)
        : pair_(pair), selection_(selection), options_of_(options_of), pools_(pools) {}

    void ours(Method method) {
        const std::string who = "cpu/" + std::string(to_string(method));
        if (wanted(selection_, who)) {
            for (const cpu::InstructionSet& set : selection_.instruction_sets) {
                add(who, [&] { return make_ours(pair_, options(method), set, selection_.threads, pools_); });
            }
        }
    }

    /// Who asks for it by name where there is no GPU is told why.
    void cuda(Method method) {
        const std::string who = "cuda/" + std::string(to_string(method));
        if (wanted(selection_, who) && (!selection_.contestants.empty() || has_gpu())) {
            add(who, [&] {
                const MatcherConfig config{pair_.left.cols, pair_.left.rows, options(method)};
                return make_with([&] { return backend("cuda").create(config); }, pair_, who, "GPU", pools_);
            });
        }
    }

    void opencv(eval::OpencvMethod method) {
        const std::string who = contestant_name(method);
        if (wanted(selection_, who)) {
            const int d_min = options(Method::sgm).range.first;
            add(who, [&] { return make_opencv(pair_, method, d_min, selection_.threads); });
        }
    }

    void naive(Method method) {
        const std::string who = "naive/" + std::string(to_string(method));
        const bool soon_done = pair_.candidates() <= max_candidates_for_naive || !selection_.contestants.empty();
        if (wanted(selection_, who) && soon_done) {
            for (const Build build : {Build::as_compiled, Build::not_vectorised}) {
                add(who, [&] { return make_naive(pair_, options(method), build, pools_); });
            }
        }
    }

    Contestants all() { return std::move(all_); }

private:
    const MatchOptions& options(Method method) const { return options_of_.at("cpu/" + std::string(to_string(method))); }

    void add(const std::string& who, const std::function<Contestants()>& create) {
        if (tools::interrupted()) {
            return;
        }
        try {
            Contestants some = create();
            std::move(some.begin(), some.end(), std::back_inserter(all_));
        } catch (const std::invalid_argument&) {
            throw;
        } catch (const std::exception& error) {
            tools::print_note(who + " is left out: " + error.what());
        }
    }

    const StereoPair& pair_;
    const Selection& selection_;
    const std::map<std::string, MatchOptions>& options_of_;
    WorkerPools& pools_;
    Contestants all_;
};

}  // namespace

void check_contestants(const std::vector<std::string>& words) {
    std::vector<std::string> known;
    for (const Method method : methods) {
        known.push_back("cpu/" + std::string(to_string(method)));
        known.push_back("cuda/" + std::string(to_string(method)));
        known.push_back("naive/" + std::string(to_string(method)));
    }
    for (const eval::OpencvMethod method : eval::opencv_methods()) {
        known.push_back(contestant_name(method));
    }
    for (const std::string& word : words) {
        if (std::none_of(known.begin(), known.end(), [&](const std::string& who) { return names(word, who); })) {
            throw std::invalid_argument("--contestant: found '" + word + "', allowed: cpu, cuda, naive, opencv, " +
                                        list_of(known));
        }
    }
}

std::vector<Method> methods_of(const std::vector<std::string>& words) {
    const Selection selection{words, {}, {}};
    std::vector<Method> chosen;
    for (const Method method : methods) {
        for (const char* const kind : {"cpu/", "cuda/", "naive/"}) {
            if (wanted(selection, kind + std::string(to_string(method)))) {
                chosen.push_back(method);
                break;
            }
        }
    }
    return chosen;
}

std::vector<cpu::InstructionSet> parse_instruction_sets(const std::string& word) {
    std::vector<cpu::InstructionSet> all = cpu::instruction_sets();
    if (word == "all") {
        return all;
    }
    std::vector<std::string> allowed = {"best", "all"};
    for (const cpu::InstructionSet& set : all) {
        if (word == set.name || word == "best") {
            return {set};
        }
        allowed.push_back(set.name);
    }
    if (word == "best") {
        return {};
    }
    throw std::invalid_argument("--isa: found '" + word + "', allowed on this machine: " + list_of(allowed));
}

Contestants line_up(const StereoPair& pair, const Selection& selection,
                    const std::map<std::string, MatchOptions>& options_of, WorkerPools& pools) {
    LineUp contestants(pair, selection, options_of, pools);
    for (const Method method : methods) {
        contestants.ours(method);
    }
    for (const Method method : methods) {
        contestants.cuda(method);
    }
    for (const eval::OpencvMethod method : eval::opencv_methods()) {
        contestants.opencv(method);
    }
    for (const Method method : methods) {
        contestants.naive(method);
    }
    return contestants.all();
}

}  // namespace disparityd::bench
