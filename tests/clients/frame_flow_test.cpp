// SPDX-License-Identifier: Apache-2.0
//
// How old frames are when a program gets them, with a daemon, a link and a program of which only the times exist.
#include "clients/cpp/frame_flow.h"

#include <algorithm>
#include <deque>
#include <fstream>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "clients/cpp/daemon_clock.h"
#include "clients/cpp/liveness.h"
#include "tests/proto/command_output.h"
#include "tests/temporary_folder.h"

namespace {

using disparity::FrameFlow;

constexpr std::int64_t ms = 1'000'000;

/// The times of what is simulated, ns.
struct Times {
    std::int64_t interval = 33 * ms;  ///< between two frames
    std::int64_t work = 0;            ///< of the program on each
    std::int64_t way = 0;             ///< of the link, each way
    std::int64_t transfer = ms / 5;   ///< of a frame's bytes
    std::int64_t matching = 12 * ms;  ///< from capture to publishing
};

/// What the program was given.
struct Given {
    std::int64_t at = 0;
    std::int64_t captured = 0;
    std::uint64_t index = 0;
};

/// A daemon that sends its newest frame against credit, a link that carries one frame after the other, and a program
/// that reads and works in turn. Advances by a tenth of a millisecond.
class Simulation {
public:
    explicit Simulation(const Times& times) : times_(times) { flow_.start(0); }

    /// Nothing passes the link from now on for so long; then all comes.
    void cut(std::int64_t time) { cut_until_ = now_ + time; }
    /// The program does nothing for so long.
    void stop(std::int64_t time) { stopped_until_ = now_ + time; }
    void set_transfer(std::int64_t transfer) { times_.transfer = transfer; }

    /// Returns what the program was given in so much time.
    std::vector<Given> run(std::int64_t time) {
        given_.clear();
        for (const std::int64_t end = now_ + time; now_ < end; now_ += ms / 10) {
            publish();
            send();
            if (now_ >= stopped_until_) {
                work_or_read();
            }
        }
        return given_;
    }

    std::uint64_t published() const { return next_; }

private:
    struct OnTheWay {
        FrameFlow::Arrival frame;
        std::int64_t arrives = 0;
    };

    void publish() {
        if (now_ >= static_cast<std::int64_t>(next_) * times_.interval + times_.matching) {
            newest_ = {.publish_index = next_, .captured_ns = static_cast<std::int64_t>(next_) * times_.interval};
            unsent_ = true;
            ++next_;
        }
    }

    void send() {
        while (!grants_.empty() && grants_.front().first <= now_) {
            credit_ = std::min<std::uint32_t>(16, credit_ + grants_.front().second);
            grants_.pop_front();
        }
        if (credit_ > 0 && unsent_) {
            --credit_;
            unsent_ = false;
            link_free_ = std::max({link_free_, now_, cut_until_}) + times_.transfer;
            newest_.sent_ns = now_;
            on_the_way_.push_back({newest_, link_free_ + times_.way});
        }
    }

    void ask(bool waiting) {
        if (const std::uint32_t frames = flow_.ask(waiting); frames > 0) {
            grants_.emplace_back(std::max(now_, cut_until_) + times_.way, frames);
        }
    }

    /// Takes what has arrived. Returns whether the program has a frame.
    bool take() {
        FrameFlow::Arrival last;
        bool any = false;
        while (!on_the_way_.empty() && on_the_way_.front().arrives <= now_) {
            last = on_the_way_.front().frame;
            last.now_ns = now_;
            last.unwatched_ns = now_ - empty_;
            last.round_trip_ns = 2 * times_.way + ms / 10;
            on_the_way_.pop_front();
            flow_.arrived(last);
            any = true;
        }
        empty_ = now_;
        if (!any || !flow_.fresh(last)) {
            return false;
        }
        ask(false);
        flow_.given(now_);
        given_.push_back({now_, last.captured_ns, last.publish_index});
        works_until_ = now_ + times_.work;
        reading_ = false;
        return true;
    }

    void work_or_read() {
        if (!reading_ && now_ < works_until_) {
            return;
        }
        if (!reading_) {
            flow_.reads(now_);
            reading_ = true;
        }
        if (!take()) {
            ask(true);
        }
    }

    Times times_;
    FrameFlow flow_;
    std::int64_t now_ = 0;
    std::uint64_t next_ = 0;
    FrameFlow::Arrival newest_;
    bool unsent_ = false;
    std::uint32_t credit_ = 0;
    std::deque<std::pair<std::int64_t, std::uint32_t>> grants_;
    std::deque<OnTheWay> on_the_way_;
    std::int64_t link_free_ = 0;
    std::int64_t cut_until_ = 0;
    std::int64_t stopped_until_ = 0;
    std::int64_t empty_ = 0;
    bool reading_ = false;
    std::int64_t works_until_ = 0;
    std::vector<Given> given_;
};

/// What the oldest frame was beyond the time that no client could save.
std::int64_t oldest(const std::vector<Given>& given, const Times& times) {
    std::int64_t most = 0;
    for (const Given& one : given) {
        most = std::max(most, one.at - one.captured - times.matching - times.transfer - 2 * times.way);
    }
    return most;
}

constexpr std::int64_t step = ms;

TEST(FrameFlow, AFrameIsAtMostAnIntervalOldHoweverLongTheProgramWorks) {
    for (const std::int64_t interval : {33 * ms, 67 * ms}) {
        for (const std::int64_t work : {0 * ms, 30 * ms, 100 * ms, 200 * ms, 1000 * ms}) {
            for (const std::int64_t way : {ms / 20, 20 * ms}) {
                for (const std::int64_t transfer : {ms / 5, 15 * ms}) {
                    const Times times{.interval = interval, .work = work, .way = way, .transfer = transfer};
                    Simulation simulation(times);
                    const auto given = simulation.run(30'000 * ms);
                    ASSERT_GE(given.size(), 20U);
                    EXPECT_LE(oldest(given, times), interval + step)
                        << "interval " << interval / ms << ", work " << work / ms << ", way " << way / ms
                        << ", transfer " << transfer / ms << " ms";
                }
            }
        }
    }
}

TEST(FrameFlow, AProgramThatKeepsUpGetsEveryFrameAtOnce) {
    for (const std::int64_t work : {0 * ms, 5 * ms, 25 * ms}) {
        for (const std::int64_t way : {ms / 20, 20 * ms, 50 * ms}) {
            for (const std::int64_t transfer : {ms / 5, 15 * ms, 25 * ms}) {
                const Times times{.work = work, .way = way, .transfer = transfer};
                Simulation simulation(times);
                simulation.run(2000 * ms);
                const std::uint64_t before = simulation.published();
                const auto given = simulation.run(10'000 * ms);
                EXPECT_GE(given.size() + 2, simulation.published() - before) << work / ms << ' ' << way / ms;
                EXPECT_LE(oldest(given, times), std::max<std::int64_t>(0, work + transfer - times.interval) + step);
            }
        }
    }
}

// 100 ms for each frame on the link, 33 ms between two: more credit would only let frames wait for each other.
TEST(FrameFlow, ALinkThatIsTooSlowHasNoQueue) {
    for (const std::int64_t way : {ms / 20, 20 * ms}) {
        const Times times{.way = way, .transfer = 100 * ms};
        Simulation simulation(times);
        const auto given = simulation.run(20'000 * ms);
        EXPECT_GE(given.size(), 120U);
        EXPECT_LE(oldest(given, times), times.interval + step);
    }
}

TEST(FrameFlow, NothingOldFollowsAPauseOfProgramOrLink) {
    for (const std::int64_t way : {ms / 20, 20 * ms}) {
        for (const bool link : {false, true}) {
            const Times times{.work = 10 * ms, .way = way};
            Simulation simulation(times);
            simulation.run(2000 * ms);
            if (link) {
                simulation.cut(1200 * ms);
            } else {
                simulation.stop(5000 * ms);
            }
            const auto given = simulation.run(10'000 * ms);
            EXPECT_LE(oldest(given, times), times.interval + step) << way / ms << (link ? " link" : " program");
            EXPECT_GE(given.size(), 140U) << "it goes on";
        }
    }
}

TEST(FrameFlow, ALinkThatBecomesSlowerStillGivesFrames) {
    Times times;
    Simulation simulation(times);
    simulation.run(2000 * ms);
    simulation.set_transfer(300 * ms);
    times.transfer = 300 * ms;
    const auto given = simulation.run(10'000 * ms);
    EXPECT_GE(given.size(), 28U);
    EXPECT_LE(oldest(given, times), times.interval + step);
}

TEST(FrameFlow, TheRateThatWasAskedForIsTheInterval) {
    FrameFlow flow;
    flow.start(4);
    EXPECT_EQ(flow.interval_ns(), 250 * ms);
}

TEST(DaemonClock, TheDaemonsClockIsNeverTakenForLess) {
    constexpr std::int64_t ahead = 5'000'000 * ms;
    disparity::DaemonClock clock;
    EXPECT_FALSE(clock.known());
    clock.add(0, ahead + 30 * ms, 40 * ms);  // 30 ms there, 10 ms back
    EXPECT_EQ(clock.latest(40 * ms), ahead + 70 * ms);
    EXPECT_EQ(clock.round_trip(), 40 * ms);
    clock.add(1000 * ms, ahead + 1002 * ms, 1030 * ms);
    EXPECT_EQ(clock.latest(1030 * ms), ahead + 1032 * ms);
    clock.add(2000 * ms, ahead + 2020 * ms, 2022 * ms);
    EXPECT_GE(clock.latest(2022 * ms), ahead + 2024 * ms) << "the best answer counts";
    EXPECT_LE(clock.latest(2022 * ms), ahead + 2025 * ms) << "with what the clocks may have drifted apart since";
}

TEST(DaemonClock, OneMachineHasOneClock) {
    disparity::DaemonClock clock;
    clock.add(100 * ms, 130 * ms, 140 * ms);
    EXPECT_EQ(clock.latest(200 * ms), 200 * ms);
    clock.forget();
    EXPECT_FALSE(clock.known());
    clock.add(100 * ms, 30 * ms, 140 * ms);
    EXPECT_EQ(clock.latest(140 * ms), 70 * ms) << "this daemon's clock is behind: it cannot be the same";
}

TEST(DaemonClock, OldAnswersAreForgotten) {
    disparity::DaemonClock clock;
    clock.add(0, 900'000 * ms, 1 * ms);
    for (std::int64_t second = 1; second <= 16; ++second) {
        const std::int64_t now = 1000 * ms * second;
        clock.add(now, 900'005 * ms + now, now + 10 * ms);
    }
    EXPECT_EQ(clock.latest(16'010 * ms), 900'005 * ms + 16'010 * ms);
}

TEST(Liveness, ASilentDaemonIsAskedAndIsGoneASecondLater) {
    disparity::Liveness daemon;
    const std::int64_t start = 1'000'000 * ms;
    EXPECT_TRUE(daemon.asks(start, start, 33 * ms)) << "its clock is not known yet";
    const std::int64_t heard = start + ms;
    EXPECT_FALSE(daemon.asks(heard + 499 * ms, heard, 33 * ms));
    EXPECT_TRUE(daemon.asks(heard + 500 * ms, heard, 33 * ms));
    EXPECT_FALSE(daemon.asks(heard + 1400 * ms, heard, 33 * ms)) << "it has been asked";
    EXPECT_FALSE(daemon.is_gone(heard + 1500 * ms, heard));
    EXPECT_TRUE(daemon.is_gone(heard + 1501 * ms, heard));
    EXPECT_FALSE(daemon.is_gone(heard + 1501 * ms, heard + 1500 * ms)) << "it has answered";
}

TEST(Liveness, ADaemonThatSaysLittleIsAskedForItsClockAlone) {
    disparity::Liveness daemon;
    const std::int64_t start = 1'000'000 * ms;
    EXPECT_TRUE(daemon.asks(start, start, 2000 * ms));
    EXPECT_FALSE(daemon.asks(start + 999 * ms, start + ms, 2000 * ms)) << "frames come every two seconds";
    EXPECT_TRUE(daemon.asks(start + 1000 * ms, start + ms, 2000 * ms));
    EXPECT_EQ(daemon.asked_ns(), start + 1000 * ms);
}

/// Does things at random, as programs and daemons do, and as only a daemon that lies does. Writes each with its
/// results.
class Steps {
public:
    Steps(std::ostream& out, std::uint32_t seed) : out_(out), random_(seed) {}

    void session() {
        const std::int64_t rate = one_in(2) ? 0 : number(1, 60'000);  // thousandths of a frame per second
        flow_.start(static_cast<double>(rate) / 1000);
        clock_.forget();
        daemon_ = {};
        heard_ = now_;
        out_ << "start " << rate << " = " << flow_.interval_ns() << '\n';
        ahead_ = one_in(2) ? 0 : number(-1'000'000 * ms, 1'000'000 * ms);
        longest_ = number(1, 150) * ms;
        question();
        for (int i = 0; i < 60; ++i) {
            turn();
        }
    }

private:
    std::int64_t number(std::int64_t least, std::int64_t most) {
        return least + static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(most - least + 1));
    }
    bool one_in(int count) { return number(1, count) == 1; }
    std::int64_t later() { return now_ += one_in(30) ? number(0, 5000 * ms) : number(0, longest_); }

    void question() {
        const std::int64_t before = now_;
        const std::int64_t daemon = one_in(40) ? disparity::sane_ns(INT64_MAX) : later() + ahead_;
        later();
        clock_.add(before, daemon, now_);
        out_ << "add " << before << ' ' << daemon << ' ' << now_ << " =\n";
    }

    void listen() {
        if (one_in(2)) {
            heard_ = now_;
        }
        const std::int64_t interval = one_in(20) ? number(0, 5'000'000 * ms) : flow_.interval_ns();
        const bool gone = daemon_.is_gone(now_, heard_);
        out_ << "is_gone " << now_ << ' ' << heard_ << " = " << gone << '\n';
        const bool asks = daemon_.asks(now_, heard_, interval);
        out_ << "asks " << now_ << ' ' << heard_ << ' ' << interval << " = " << asks << '\n';
    }

    void ask(bool waiting) {
        const std::uint32_t more = flow_.ask(waiting);
        out_ << "ask " << waiting << " = " << more << '\n';
    }

    void tell(const char* what, const FrameFlow::Arrival& frame) {
        out_ << what << ' ' << frame.publish_index << ' ' << frame.captured_ns << ' ' << frame.sent_ns << ' '
             << frame.now_ns << ' ' << frame.unwatched_ns << ' ' << frame.round_trip_ns << " = ";
    }

    void turn() {
        if (one_in(4)) {
            question();
        }
        flow_.reads(later());
        out_ << "reads " << now_ << " =\n";
        listen();
        if (!one_in(4)) {  // otherwise a frame lies there already
            ask(true);
        }
        FrameFlow::Arrival frame;
        frame.publish_index = index_ += static_cast<std::uint64_t>(one_in(10) ? number(0, 9) : 1);
        frame.sent_ns = now_ + ahead_;
        frame.captured_ns = frame.sent_ns - number(0, 30 * ms);
        if (one_in(50)) {
            frame.sent_ns = disparity::sane_ns(one_in(2) ? INT64_MAX : INT64_MIN);
            frame.captured_ns = frame.sent_ns * (one_in(2) ? 2 : -2);
            frame.publish_index = random_();
        }
        frame.unwatched_ns = later() - now_ + number(0, 200 * ms);
        frame.now_ns = clock_.latest(now_);
        frame.round_trip_ns = clock_.round_trip();
        out_ << "latest " << now_ << " = " << frame.now_ns << ' ' << frame.round_trip_ns << '\n';
        flow_.arrived(frame);
        tell("arrived", frame);
        out_ << flow_.interval_ns() << ' ' << flow_.patience_ns() << '\n';
        if (one_in(8)) {
            return;  // another one came behind it
        }
        const bool fresh = flow_.fresh(frame);
        tell("fresh", frame);
        out_ << fresh << ' ' << flow_.patience_ns() << '\n';
        if (fresh) {
            ask(false);
            flow_.given(later());
            out_ << "given " << now_ << " =\n";
        }
    }

    std::ostream& out_;
    std::mt19937_64 random_;
    FrameFlow flow_;
    disparity::DaemonClock clock_;
    disparity::Liveness daemon_;
    std::int64_t heard_ = 0;
    std::int64_t now_ = 1'000'000 * ms;
    std::int64_t ahead_ = 0;
    std::int64_t longest_ = 0;
    std::uint64_t index_ = 0;
};

TEST(FrameFlow, PythonDoesTheSame) {
    const std::string check = FRAME_FLOW_CHECK;
    if (check.empty()) {
        GTEST_SKIP() << "no Python that this test may start";
    }
    const disparityd::test::TemporaryFolder folder;
    const std::string path = folder.file("steps");
    std::ofstream file(path);
    Steps steps(file, 1);
    for (int i = 0; i < 100; ++i) {
        steps.session();
    }
    file.close();
    const auto [status, text] = command_output(check + " " + path + " 2>&1");
    EXPECT_EQ(status, 0) << text;
}

}  // namespace
