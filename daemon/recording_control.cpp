// SPDX-License-Identifier: Apache-2.0
#include "daemon/recording_control.h"

#include <filesystem>
#include <stdexcept>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "capture/message_text.h"
#include "daemon/log.h"
#include "proto/record_message.h"

namespace disparityd {
namespace {

namespace fs = std::filesystem;

/// The file that `path` stands for inside the folder.
std::string target_path(const std::string& path, const std::string& directory) {
    const auto refuse = [&](const std::string& why) {
        throw std::invalid_argument(
            fmt::format("record: path: found \"{}\", {}, allowed: a new file in {} ([record] directory)",
                        capture::shown(path), why, directory));
    };
    std::error_code error;
    const fs::path base = fs::canonical(directory, error);
    if (error) {
        throw std::runtime_error(fmt::format("[record] directory: {}: {}", directory, error.message()));
    }
    const fs::path target = fs::weakly_canonical(base / path, error);
    const bool plain = capture::shown(path, path.size()) == path;
    if (error || path.empty() || !plain || !target.has_filename()) {
        refuse("which is no file name");
    }
    const auto relative = target.lexically_relative(base);
    if (relative.empty() || *relative.begin() == ".." || relative == ".") {
        refuse("which lies outside");
    }
    if (fs::exists(target, error)) {
        refuse("which exists already");
    }
    return target.string();
}

}  // namespace

RecordingControl::~RecordingControl() {
    worker_.join();
    finish("");
}

void RecordingControl::configure(bool enabled, std::string directory) {
    const std::lock_guard lock(mutex_);
    enabled_ = enabled;
    directory_ = std::move(directory);
}

void RecordingControl::set_source(std::optional<capture::SourceInfo> source, const std::string& reason) {
    finish(reason);
    const std::lock_guard lock(mutex_);
    source_ = std::move(source);
}

void RecordingControl::start(const std::string& path, Answer answer) {
    boost::asio::post(worker_, [this, path, answer = std::move(answer)] {
        std::string refusal;
        try {
            start_now(path);
        } catch (const std::exception& error) {
            refusal = error.what();
        }
        answer(status(), refusal);
    });
}

void RecordingControl::stop(Answer answer) {
    boost::asio::post(worker_, [this, answer = std::move(answer)] {
        const bool running = status().active();
        finish("");
        answer(status(), running ? "" : "record: nothing is being recorded");
    });
}

void RecordingControl::start_now(const std::string& path) {
    const std::lock_guard operation(operation_);
    std::string directory;
    capture::SourceInfo source;
    {
        const std::lock_guard lock(mutex_);
        if (!enabled_) {
            throw std::invalid_argument("record: refused, allowed only with [record] enabled = true");
        }
        if (recorder_) {
            throw std::invalid_argument("record: a recording to " + path_ +
                                        " is running: stop it first (disparityctl record --stop)");
        }
        if (!source_) {
            throw std::runtime_error("record: there is no source to record at the moment");
        }
        directory = directory_;
        source = *source_;
    }
    const std::string target = target_path(path, directory);
    auto recorder = std::make_shared<capture::Recorder>(target, source);
    log_info(fmt::format("recording to {}", target));
    const std::lock_guard lock(mutex_);
    path_ = target;
    recorder_ = std::move(recorder);
}

void RecordingControl::finish(const std::string& reason) {
    const std::lock_guard operation(operation_);
    std::shared_ptr<capture::Recorder> recorder;
    {
        const std::lock_guard lock(mutex_);
        recorder = std::move(recorder_);
        recorder_.reset();
        if (recorder) {  // what status() tells while it is being finished
            last_ = proto::record_message(recorder->status(), path_, true);
        }
    }
    if (!recorder) {
        return;
    }
    capture::Recorder::Status end = recorder->finish();
    if (end.error.empty()) {
        end.error = reason;
    }
    log_line(end.error.empty() ? LogLevel::info : LogLevel::warning,
             fmt::format("recording {} finished: {} frames, {} lost, {} lost by the source, {} bytes{}{}", path_,
                         end.frames, end.lost, end.source_lost, end.bytes, end.error.empty() ? "" : "; ", end.error));
    const std::lock_guard lock(mutex_);
    last_ = proto::record_message(end, path_, false);
}

void RecordingControl::check() {
    const v1::RecordStatus now = status();
    if (!now.path().empty() && now.active() && !now.error().empty()) {
        finish(now.error());
    } else if (now.active() && now.lost() > 0 && now.path() != slow_) {
        slow_ = now.path();
        log_warning(capture::Recorder::slow_disk_text(now.path()));
    }
}

v1::RecordStatus RecordingControl::status() const {
    const std::lock_guard lock(mutex_);
    return recorder_ ? proto::record_message(recorder_->status(), path_, true) : last_;
}

void RecordingControl::offer(const capture::RawFrame& frame) noexcept {
    const std::lock_guard lock(mutex_);
    if (recorder_) {
        recorder_->offer(frame);
    }
}

}  // namespace disparityd
