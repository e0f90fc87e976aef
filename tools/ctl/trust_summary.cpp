// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/trust_summary.h"

#include "base/words.h"
#include "tools/command_line/table.h"

namespace disparityd::tools {

void TrustSummary::add(const trust::Verdict& verdict) {
    if (verdict.trust == 0) {
        return;
    }
    ++frames_;
    sum_ += verdict.trust;
    for (std::size_t i = 0; i < with_.size(); ++i) {
        with_[i] += (verdict.doubts & proto::doubts[i].bit) != 0 ? 1 : 0;
    }
}

json::Json TrustSummary::as_json() const {
    if (frames_ == 0) {
        return {};
    }
    json::Json with = json::Json::object();
    for (std::size_t i = 0; i < with_.size(); ++i) {
        if (with_[i] > 0) {
            with[std::string(proto::doubts[i].name)] = with_[i];
        }
    }
    return {{"mean", mean()}, {"frames_with", with}};
}

std::string TrustSummary::text() const {
    if (frames_ == 0) {
        return {};
    }
    std::string text = "trust: " + fixed(100 * mean(), 0) + " % on the average";
    for (std::size_t i = 0; i < with_.size(); ++i) {
        if (with_[i] > 0) {
            text += ", " + std::string(proto::doubts[i].name) + " in " + base::counted(with_[i], "frame");
        }
    }
    return text;
}

}  // namespace disparityd::tools
