// SPDX-License-Identifier: Apache-2.0
#include "daemon/recording_control.h"

#include <filesystem>
#include <future>
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
    {
        const std::lock_guard lock(mutex_);
        end("");
    }
    finish_ended();
}

void RecordingControl::configure(bool enabled, std::string directory) {
    const std::lock_guard lock(mutex_);
    enabled_ = enabled;
    directory_ = std::move(directory);
}

void RecordingControl::set_source(std::optional<capture::SourceInfo> source, const std::string& reason) {
    const std::lock_guard lock(mutex_);
    source_ = std::move(source);
    ++source_number_;
    end_in_background(reason);
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
    // One that is being finished has a status to tell of, when it is asked for now.
    const bool running = status().active();
    boost::asio::post(worker_, [this, running, answer = std::move(answer)] {
        bool ended = false;
        {
            const std::lock_guard lock(mutex_);
            ended = end("");
        }
        finish_ended();
        answer(status(), running || ended ? "" : "record: nothing is being recorded");
    });
}

void RecordingControl::wait() {
    std::promise<void> finished;
    boost::asio::post(worker_, [&finished] { finished.set_value(); });  // what was ended is in front of it
    finished.get_future().wait();
}

void RecordingControl::start_now(const std::string& path) {
    std::string directory;
    capture::SourceInfo source;
    unsigned number = 0;
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
        number = source_number_;
    }
    finish_ended();  // nothing more is ended until there is a recorder again
    const std::string target = target_path(path, directory);
    const auto recorder = std::make_shared<capture::Recorder>(target, source);
    bool same_source = false;
    {
        const std::lock_guard lock(mutex_);
        same_source = source_number_ == number;
        if (same_source) {
            path_ = target;
            recorder_ = recorder;
        }
    }
    if (!same_source) {
        recorder->finish();
        std::error_code ignored;
        fs::remove(target, ignored);
        throw std::runtime_error("record: the source has changed while the file was opened: start it again");
    }
    log_info(fmt::format("recording to {}", target));
}

bool RecordingControl::end(const std::string& reason) {
    if (!recorder_) {
        return false;
    }
    last_ = current();
    ended_ = {std::exchange(recorder_, nullptr), path_, reason};
    return true;
}

void RecordingControl::end_in_background(const std::string& reason) {
    if (end(reason)) {
        boost::asio::post(worker_, [this] { finish_ended(); });
    }
}

void RecordingControl::finish_ended() {
    Ended ended;
    {
        const std::lock_guard lock(mutex_);
        ended = std::exchange(ended_, {});
    }
    if (!ended.recorder) {
        return;
    }
    capture::Recorder::Status status = ended.recorder->finish();
    if (status.error.empty()) {
        status.error = ended.reason;
    }
    log_line(status.error.empty() ? LogLevel::info : LogLevel::warning,
             fmt::format("recording {} finished: {} frames, {} lost, {} lost by the source, {} bytes{}{}", ended.path,
                         status.frames, status.lost, status.source_lost, status.bytes, status.error.empty() ? "" : "; ",
                         status.error));
    const std::lock_guard lock(mutex_);
    last_ = proto::record_message(status, ended.path, false);
}

void RecordingControl::check() {
    v1::RecordStatus now;
    {
        const std::lock_guard lock(mutex_);
        now = current();
        if (recorder_ && !now.error().empty()) {
            end_in_background(now.error());
            return;
        }
    }
    if (now.active() && now.lost() > 0 && now.path() != slow_) {
        slow_ = now.path();
        log_warning(capture::Recorder::slow_disk_text(now.path()));
    }
}

v1::RecordStatus RecordingControl::status() const {
    const std::lock_guard lock(mutex_);
    return current();
}

v1::RecordStatus RecordingControl::current() const {
    return recorder_ ? proto::record_message(recorder_->status(), path_, true) : last_;
}

void RecordingControl::offer(const capture::RawFrame& frame) noexcept {
    const std::lock_guard lock(mutex_);
    if (recorder_) {
        recorder_->offer(frame);
    }
}

}  // namespace disparityd
