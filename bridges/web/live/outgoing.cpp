// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/outgoing.h"

#include <algorithm>
#include <utility>

#include "base/freed_memory.h"

namespace disparityd::web {
namespace {

/// The heaps keep what is freed. After so much of it they give it back.
constexpr std::size_t worth_giving_back = std::size_t{8} << 20U;

std::chrono::milliseconds patience_for(std::size_t bytes) {
    constexpr std::size_t bytes_in_a_ms = (std::size_t{1} << 20U) / 1000;
    return std::chrono::milliseconds(2000 + bytes / bytes_in_a_ms);
}

}  // namespace

Outgoing::Load::~Load() {
    all_.release(*this);
}

std::unique_ptr<Outgoing::Load> Outgoing::hold(std::size_t bytes, Time now, std::function<void()> drop) {
    std::unique_ptr<Load> load(new Load(*this, bytes, now, std::move(drop)));
    load->place_ = loads_.insert(loads_.end(), load.get());
    bytes_ += bytes;
    peak_ = std::max(peak_, bytes_);
    return load;
}

void Outgoing::release(const Load& load) {
    loads_.erase(load.place_);
    bytes_ -= load.bytes_;
    if (peak_ >= worth_giving_back && bytes_ < peak_ / 4) {
        peak_ = bytes_;
        base::give_back_freed_memory();
    }
}

bool Outgoing::has_room(Time now, std::size_t most) {
    while (bytes_ >= most) {
        if (!end_slowest(now)) {
            return false;
        }
    }
    return true;
}

/// Ends the connection of the largest load that has had its time. What it held counts no more: it is freed as soon as
/// the network's thread comes to it.
bool Outgoing::end_slowest(Time now) {
    Load* slowest = nullptr;
    for (Load* const load : loads_) {
        const bool slow = load->drop_ && now - load->since_ > patience_for(load->bytes_);
        if (slow && (slowest == nullptr || load->bytes_ > slowest->bytes_)) {
            slowest = load;
        }
    }
    if (slowest == nullptr) {
        return false;
    }
    bytes_ -= std::exchange(slowest->bytes_, 0);
    std::exchange(slowest->drop_, nullptr)();
    return true;
}

}  // namespace disparityd::web
