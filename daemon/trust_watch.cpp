// SPDX-License-Identifier: Apache-2.0
#include "daemon/trust_watch.h"

#include <fmt/format.h>

#include "proto/scan.h"

namespace disparityd::daemon {
namespace {

constexpr bool same(proto::Doubt one, v1::FrameFlags other) {
    return std::uint32_t{one} == static_cast<std::uint32_t>(other);
}
static_assert(same(proto::doubt_dark, v1::DARK) && same(proto::doubt_saturated, v1::SATURATED) &&
              same(proto::doubt_blurred, v1::BLURRED) && same(proto::doubt_dirty_eye, v1::DIRTY_EYE) &&
              same(proto::doubt_covered_eye, v1::COVERED_EYE) && same(proto::doubt_misaligned, v1::MISALIGNED) &&
              same(proto::doubt_too_near, v1::TOO_NEAR) && same(proto::doubt_noisy, v1::NOISY));

double seconds(TrustWatch::Time from, TrustWatch::Time to) {
    return std::chrono::duration<double>(to - from).count();
}

}  // namespace

void TrustWatch::note_scan(const Plane<const std::uint8_t>& scan) noexcept {
    if (scan.data == nullptr) {
        return;
    }
    const auto& head = *reinterpret_cast<const proto::ScanHead*>(scan.data);
    const auto* sector = reinterpret_cast<const proto::ScanSector*>(scan.data + sizeof head);
    Sectors found;
    found.all = head.sectors;
    for (std::uint32_t s = 0; s < found.all; ++s) {
        const std::uint32_t doubts = std::uint32_t{sector[s].doubts} << proto::scan_doubt_shift;
        found.doubted += doubts != 0 ? 1 : 0;
        for (std::size_t i = 0; i < found.with.size(); ++i) {
            found.with[i] += (doubts & proto::doubts[i].bit) != 0 ? 1 : 0;
        }
    }
    const std::lock_guard lock(mutex_);
    sectors_ = found;
}

std::optional<v1::ScanStatus> TrustWatch::scan_status() const {
    const std::lock_guard lock(mutex_);
    if (sectors_.all == 0) {
        return std::nullopt;
    }
    v1::ScanStatus status;
    status.set_sectors(sectors_.all);
    status.set_doubted(sectors_.doubted);
    for (std::size_t i = 0; i < sectors_.with.size(); ++i) {
        if (sectors_.with[i] > 0) {
            v1::SectorDoubt& doubt = *status.add_doubts();
            doubt.set_doubt(std::string(proto::doubts[i].name));
            doubt.set_sectors(sectors_.with[i]);
        }
    }
    return status;
}

std::vector<std::string> TrustWatch::check(Time now) {
    const std::uint32_t flags = newest_.load(std::memory_order_relaxed);
    std::vector<std::string> lines;
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < since_.size(); ++i) {
        const proto::DoubtFacts& doubt = proto::doubts[i];
        const bool holds = doubt.alarm && (flags & doubt.bit) != 0;
        if (holds && !since_[i]) {
            since_[i] = now;
            lines.push_back(fmt::format("alarm {}: {}; {}", doubt.name, doubt.meaning, doubt.remedy));
        } else if (!holds && since_[i]) {
            lines.push_back(fmt::format("the alarm {} is over after {:.0f} s", doubt.name, seconds(*since_[i], now)));
            since_[i].reset();
        }
    }
    return lines;
}

std::optional<TrustWatch::Finding> TrustWatch::finding(Time now) const {
    const std::uint32_t flags = newest_.load(std::memory_order_relaxed);
    const std::uint32_t trust = flags >> proto::trust_shift;
    if (trust == 0) {
        return std::nullopt;
    }
    Finding finding;
    finding.ratio = trust / 255.0;
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < since_.size(); ++i) {
        const proto::DoubtFacts& doubt = proto::doubts[i];
        if ((flags & doubt.bit) != 0) {
            finding.doubts.push_back(doubt.name);
        }
        if (since_[i]) {
            finding.alarm += fmt::format("{}{} for {:.0f} s: {}; {}", finding.alarm.empty() ? "" : ". ", doubt.name,
                                         seconds(*since_[i], now), doubt.meaning, doubt.remedy);
        }
    }
    return finding;
}

}  // namespace disparityd::daemon
