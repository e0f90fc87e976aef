// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/recording_control.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <future>
#include <stdexcept>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "base/failure_text.h"
#include "base/message_text.h"
#include "base/out_of_memory.h"
#include "base/words.h"
#include "daemon/log.h"
#include "proto/record_message.h"

namespace disparityd::daemon {
namespace {

namespace fs = std::filesystem;

/// Returns whether the name is neither that of a hidden file nor an option of a command. Letters of other alphabets are
/// bytes from 0x80 on.
bool begins_like_a_name(const std::string& part) {
    const unsigned char first = part.empty() ? 0 : static_cast<unsigned char>(part.front());
    return first >= 0x80 || std::isalnum(first) != 0;
}

constexpr const char* not_answered = "a request about recordings is not answered";

/// Returns the absolute path of `path` inside the folder. Throws if it is not allowed.
std::string target_path(const std::string& path, const std::string& directory) {
    const auto refuse = [&](const std::string& why) {
        throw std::invalid_argument(
            fmt::format("record: path: found \"{}\", {}, allowed: a new file in {} ([record] directory)",
                        base::printable(path), why, directory));
    };
    std::error_code error;
    const fs::path base = fs::canonical(directory, error);
    if (error) {
        throw std::runtime_error(fmt::format("[record] directory: {}: {}", directory, base::error_text(error.value())));
    }
    const fs::path target = fs::weakly_canonical(base / path, error);
    const bool plain = base::printable(path, path.size()) == path;
    if (error || path.empty() || !plain || !target.has_filename()) {
        refuse("which is no file name");
    }
    const auto relative = target.lexically_relative(base);
    if (relative.empty() || *relative.begin() == ".." || relative == ".") {
        refuse("which lies outside");
    }
    if (!std::all_of(relative.begin(), relative.end(), [](const fs::path& part) { return begins_like_a_name(part); })) {
        refuse("each part of which must begin with a letter or a digit");
    }
    if (target.extension() != ".mkv") {
        refuse("which does not end in .mkv");
    }
    if (fs::exists(target, error)) {
        refuse("which exists already");
    }
    return target.string();
}

constexpr double bytes_per_mb = 1e6;

/// Returns the free bytes of the disk of `path`, for users other than root; nothing if the file system does not report
/// it.
std::optional<std::uintmax_t> free_bytes(const fs::path& path) {
    std::error_code error;
    const fs::space_info space = fs::space(path, error);
    const bool told = !error && space.capacity != 0 && space.capacity != static_cast<std::uintmax_t>(-1);
    return told ? std::optional(space.available) : std::nullopt;
}

std::string too_full(std::uintmax_t free, std::uint64_t keep) {
    return fmt::format("{:.0f} MB are free on the disk, allowed: at least {:.0f} MB ([record] keep_free_mb)",
                       static_cast<double>(free) / bytes_per_mb, static_cast<double>(keep) / bytes_per_mb);
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

void RecordingControl::configure(RecordRules rules) {
    const std::lock_guard lock(mutex_);
    rules_ = std::move(rules);
}

void RecordingControl::set_source(std::optional<capture::SourceInfo> source, const std::string& reason) {
    const std::lock_guard lock(mutex_);
    source_ = std::move(source);
    ++source_number_;
    end_in_background(reason);
}

void RecordingControl::start(const WantedRecording& wanted, Answer answer) {
    do_in(worker_, not_answered, [this, wanted, answer = std::move(answer)] {
        std::string refusal;
        try {
            const base::MemoryMayBeRefused refusable;
            start_now(wanted);
        } catch (const std::exception& error) {
            refusal = base::failure_text(error);
        }
        answer(status(), refusal);
    });
}

void RecordingControl::stop(Answer answer) {
    // The recording may end before the worker runs this; its status is still the answer.
    const bool running = status().active();
    do_in(worker_, not_answered, [this, running, answer = std::move(answer)] {
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

void RecordingControl::start_now(const WantedRecording& wanted) {
    RecordRules rules;
    capture::SourceInfo source;
    unsigned number = 0;
    {
        const std::lock_guard lock(mutex_);
        if (!rules_.enabled) {
            throw std::invalid_argument("record: refused, allowed only with [record] enabled = true");
        }
        if (!rules_.directory_is_chosen && !wanted.owner) {
            throw std::invalid_argument(
                "record: refused, allowed: for the daemon's own user over the Unix socket; for others only where "
                "[record] directory names a folder");
        }
        if (recorder_) {
            throw std::invalid_argument("record: a recording to " + path_ + " is running: stop it first");
        }
        if (!source_) {
            throw std::runtime_error("record: there is no source to record at the moment");
        }
        rules = rules_;
        source = *source_;
        number = source_number_;
    }
    finish_ended();  // nothing more is ended until there is a recorder again
    const std::string target = target_path(wanted.path, rules.directory);
    if (const auto free = free_bytes(fs::path(target).parent_path()); free && *free < rules.keep_free_bytes) {
        throw std::runtime_error(fmt::format("record: {}: {}", target, too_full(*free, rules.keep_free_bytes)));
    }
    const auto recorder = std::make_shared<capture::Recorder>(target, source);
    bool same_source = false;
    {
        const std::lock_guard lock(mutex_);
        same_source = source_number_ == number;
        if (same_source) {
            path_ = target;
            recorder_ = recorder;
            client_ = wanted.client;
        }
    }
    if (!same_source) {
        recorder->finish();
        std::error_code ignored;
        fs::remove(target, ignored);
        throw std::runtime_error("record: the source has changed while the file was opened: start it again");
    }
    began_.write(LogLevel::info, fmt::format("recording to {}", target));
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
        do_in(worker_, "a recording cannot be finished", [this] { finish_ended(); });
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
    std::error_code stays;
    const bool removed = status.frames == 0 && fs::remove(ended.path, stays);
    const bool well = status.error.empty();
    (well ? finished_ : broke_off_)
        .write(well ? LogLevel::info : LogLevel::warning,
               fmt::format("recording {} finished: {}, {} dropped, {} lost by the source, {} bytes{}{}{}", ended.path,
                           base::counted(status.frames, "frame"), status.dropped, status.lost, status.bytes,
                           removed ? ", removed, as it had no frame" : "", well ? "" : "; ", status.error));
    const std::lock_guard lock(mutex_);
    last_ = proto::record_message(status, ended.path, false);
    last_.set_removed(removed);
}

std::string RecordingControl::limit_reached(const v1::RecordStatus& now) const {
    if (rules_.max_bytes > 0 && now.bytes() >= rules_.max_bytes) {
        return fmt::format("it has reached [record] max_mb = {:.0f}",
                           static_cast<double>(rules_.max_bytes) / bytes_per_mb);
    }
    if (rules_.max_time.count() > 0 && now.seconds() >= static_cast<double>(rules_.max_time.count())) {
        return fmt::format("it has reached [record] max_s = {}", rules_.max_time.count());
    }
    return {};
}

/// Asks the worker for the free space; a disk that does not answer blocks the worker only.
void RecordingControl::watch_space() {
    if (rules_.keep_free_bytes > 0 && !looking_for_space_) {
        do_in(worker_, "the room on the disk is not looked at", [this] { look_for_space(); });
        looking_for_space_ = true;
    }
}

void RecordingControl::look_for_space() {
    std::shared_ptr<capture::Recorder> recorder;
    std::string path;
    std::uint64_t keep = 0;
    {
        const std::lock_guard lock(mutex_);
        recorder = recorder_;
        path = path_;
        keep = rules_.keep_free_bytes;
    }
    const auto free = recorder ? free_bytes(path) : std::nullopt;
    {
        const std::lock_guard lock(mutex_);
        if (free && *free < keep && recorder_ == recorder) {
            end(too_full(*free, keep));
        }
        looking_for_space_ = false;
    }
    recorder.reset();
    finish_ended();
}

void RecordingControl::client_is_gone(std::uint64_t client) {
    const std::lock_guard lock(mutex_);
    if (rules_.ends_with_client && recorder_ && client_ == client) {
        end_in_background("the client that had asked for it is gone ([record] when_client_is_gone = \"stop\")");
    }
}

void RecordingControl::check() {
    v1::RecordStatus now;
    {
        const std::lock_guard lock(mutex_);
        now = current();
        if (recorder_) {
            const std::string reason = now.error().empty() ? limit_reached(now) : now.error();
            if (!reason.empty()) {
                end_in_background(reason);
                return;
            }
            watch_space();
        }
    }
    if (now.active() && now.dropped() > 0 && now.path() != slow_) {
        slow_ = now.path();
        log_warning(capture::Recorder::slow_disk_text(now.path()));
    }
}

v1::RecordStatus RecordingControl::status() const {
    const std::lock_guard lock(mutex_);
    return current();
}

bool RecordingControl::is_recording() const {
    const std::lock_guard lock(mutex_);
    return recorder_ != nullptr;
}

bool RecordingControl::is_recording_for(std::uint64_t client) const {
    const std::lock_guard lock(mutex_);
    return recorder_ && client_ == client;
}

v1::RecordStatus RecordingControl::current() const {
    return recorder_ ? proto::record_message(recorder_->status(), path_, true) : last_;
}

/// The copy of the frame is made without the lock, or whoever asks for the status would wait for it. A recording that
/// ends meanwhile is finished after the copy: Recorder::finish() waits for it.
void RecordingControl::offer(const capture::RawFrame& frame) noexcept {
    std::shared_ptr<capture::Recorder> recorder;
    {
        const std::lock_guard lock(mutex_);
        recorder = recorder_;
    }
    if (recorder) {
        recorder->offer(frame);
    }
}

}  // namespace disparityd::daemon
