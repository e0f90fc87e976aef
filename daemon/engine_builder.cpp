// SPDX-License-Identifier: Apache-2.0
#include "daemon/engine_builder.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "base/out_of_memory.h"
#include "base/start_thread.h"
#include "capture/shown_source.h"
#include "daemon/log.h"

namespace disparityd::daemon {
namespace {

/// What a source's preparation throws through open_source() when the builder is cancelled.
struct Cancelled {};

}  // namespace

EngineBuilder::EngineBuilder(Make make, std::function<void()> done) : make_(std::move(make)), done_(std::move(done)) {}

EngineBuilder::~EngineBuilder() {
    cancel();
    wait();
}

void EngineBuilder::build(BuildReason reason, Config config) noexcept {
    busy_ = true;
    built_.reason = reason;
    try {
        log_info(fmt::format("preparing {}", capture::shown_source(config.source.uri)));
        for (const std::string& note : config.notes) {
            log_info(note);
        }
        wait();  // the thread of the last build has given its result and is about to end
        built_.config = std::make_unique<const Config>(std::move(config));
        thread_ = base::start_thread([this] { make_engine(); });
    } catch (...) {
        built_.failure = std::current_exception();
        ready_.store(true);
        done_();
    }
}

void EngineBuilder::make_engine() {
    try {
        const base::MemoryMayBeRefused refusable;
        built_.engine = make_(*built_.config, [this](int, int) {
            if (cancelled_.load(std::memory_order_relaxed)) {
                throw Cancelled();
            }
        });
    } catch (const Cancelled&) {
        return;
    } catch (...) {
        built_.failure = std::current_exception();
    }
    ready_.store(true);
    done_();
}

std::optional<EngineBuilder::Built> EngineBuilder::take() {
    if (!ready_.exchange(false)) {
        return std::nullopt;
    }
    busy_ = false;
    return std::exchange(built_, {});
}

void EngineBuilder::wait() {
    if (thread_.joinable()) {
        thread_.join();
    }
}

}  // namespace disparityd::daemon
