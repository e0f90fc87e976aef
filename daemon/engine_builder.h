// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

#include "daemon/build_reason.h"
#include "daemon/config/config.h"
#include "daemon/engine.h"

namespace disparityd::daemon {

/// Builds engines, one at a time, each in a thread of its own: a slow source delays nobody. All functions are for one
/// thread, the owner's.
class EngineBuilder {
public:
    /// A source reports its preparation by this function, which throws when the builder is cancelled.
    using Progress = std::function<void(int done, int total)>;
    /// Makes an engine, in the builder's thread. What it throws is the failure of the build.
    using Make = std::function<std::shared_ptr<Engine>(const Config& config, const Progress& progress)>;

    /// What has come of a build: an engine, or the exception that prevented it.
    struct Built {
        BuildReason reason = BuildReason::start;
        std::unique_ptr<const Config> config;  ///< null only where there is no engine
        std::shared_ptr<Engine> engine;
        std::exception_ptr failure;
    };

    /// `done` is called when take() has something, in the builder's thread or the owner's; it must not throw.
    EngineBuilder(Make make, std::function<void()> done);
    /// Cancels and waits.
    ~EngineBuilder();
    EngineBuilder(const EngineBuilder&) = delete;
    EngineBuilder& operator=(const EngineBuilder&) = delete;

    /// Starts a build; not while busy(). Every failure, such as one to start a thread, is a result that take() returns.
    void build(BuildReason reason, Config config) noexcept;

    /// Whether a build has begun whose result take() has not returned. A cancelled build has no result and stays busy.
    bool busy() const { return busy_; }

    /// The result once it is there.
    std::optional<Built> take();

    /// A build ends at the next progress of its source and has no result. Later builds end in the same way.
    void cancel() { cancelled_.store(true, std::memory_order_relaxed); }

    /// Waits for the end of the thread.
    void wait();

private:
    void make_engine();

    const Make make_;
    const std::function<void()> done_;
    bool busy_ = false;
    Built built_;  ///< the thread's until `ready_`
    std::atomic<bool> ready_{false};
    std::atomic<bool> cancelled_{false};
    std::thread thread_;
};

}  // namespace disparityd::daemon
