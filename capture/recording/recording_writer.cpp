// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_writer.h"

extern "C" {
#include <libavutil/opt.h>
}

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <optional>
#include <span>
#include <stdexcept>

#include "base/failure_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/calibration_identity.h"
#include "capture/pixel_format.h"
#include "capture/recording/recording_checksum.h"
#include "capture/recording/recording_ffmpeg.h"
#include "capture/recording/recording_file.h"
#include "capture/recording/recording_format.h"
#include "capture/recording/recording_pixels.h"
#include "capture/recording/recording_segment.h"
#include "capture/recording/recording_sensors.h"

namespace disparityd::capture {
namespace {

// A killed writer loses what is not in the file yet, at most one cluster of this length.
constexpr std::int64_t cluster_ms = 500;
constexpr std::uint64_t cluster_bytes = 4U << 20U;

constexpr std::size_t most_jpeg_bytes = std::size_t{1} << 28;

struct MuxerDelete {
    void operator()(AVFormatContext* muxer) const { avformat_free_context(muxer); }
};
using MuxerPtr = std::unique_ptr<AVFormatContext, MuxerDelete>;

void check(const std::string& path, const SourceInfo& info) {
    const std::string found =
        "found " + std::to_string(info.eye_width) + " x " + std::to_string(info.height) + " per eye";
    if (info.eye_width < 1 || info.height < 1 || info.eye_width > recording::max_side / 2 ||
        info.height > recording::max_side || std::int64_t{2} * info.eye_width * info.height > recording::max_pixels) {
        throw std::invalid_argument(path + ": cannot record frames of this size: " + found + ", allowed 1 x 1 to " +
                                    std::to_string(recording::max_side / 2) + " x " +
                                    std::to_string(recording::max_side) + " and " +
                                    std::to_string(recording::max_pixels / 2) + " pixels");
    }
    if (info.format == PixelFormat::yuyv && info.eye_width % 2 != 0) {
        throw std::invalid_argument(path + ": cannot record yuyv frames of odd width: " + found +
                                    ", allowed an even width");
    }
}

CodecPtr open_encoder(const SourceInfo& info) {
    const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_FFVHUFF);
    if (codec == nullptr) {
        throw std::runtime_error("this FFmpeg has no ffvhuff encoder; install the distribution's libavcodec");
    }
    CodecPtr encoder(or_bad_alloc(avcodec_alloc_context3(codec)));
    encoder->width = 2 * info.eye_width;
    encoder->height = info.height;
    encoder->pix_fmt = stored_format(info.format);
    encoder->time_base = {1, 1000};
    encoder->thread_count = 1;  // a frame comes out at once, and the pipeline keeps its cores
    encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    if (info.format != PixelFormat::yuyv) {
        encoder->color_range = AVCOL_RANGE_JPEG;
    }
    av_opt_set(encoder->priv_data, "pred", "left", 0);
    av_opt_set_int(encoder->priv_data, "context", 1, 0);
    clear_ffmpeg_log();
    if (const int error = avcodec_open2(encoder.get(), codec, nullptr); error < 0) {
        throw std::runtime_error("the ffvhuff encoder refuses " + std::to_string(encoder->width) + " x " +
                                 std::to_string(encoder->height) + ": " + ffmpeg_reason(error));
    }
    return encoder;
}

FramePtr frame_for(const AVCodecContext& encoder) {
    FramePtr frame(or_bad_alloc(av_frame_alloc()));
    frame->width = encoder.width;
    frame->height = encoder.height;
    frame->format = encoder.pix_fmt;
    frame->color_range = encoder.color_range;
    if (av_frame_get_buffer(frame.get(), 0) < 0) {
        throw std::bad_alloc();
    }
    return frame;
}

AVDictionary* tags_of(const SourceInfo& info) {
    AVDictionary* tags = nullptr;
    auto set = [&](const char* key, const std::string& value) { av_dict_set(&tags, key, value.c_str(), 0); };
    set(recording::tag_format, std::string(info.jpegs ? recording::version_of_jpegs : recording::version_of_pixels));
    set(recording::tag_source, info.name);
    if (info.synthetic) {
        set(recording::tag_synthetic, "1");
    }
    if (info.time_offset_us != 0) {
        set(recording::tag_time_offset, std::to_string(info.time_offset_us));
    }
    set(recording::tag_pixels, std::string(to_string(info.format)));
    set(recording::tag_eye_width, std::to_string(info.eye_width));
    if (info.jpegs) {
        set(recording::tag_layout, info.jpegs->top_bottom ? "top-bottom" : "side-by-side");
        set(recording::tag_first, info.jpegs->right_first ? "right" : "left");
    }
    set(recording::tag_rate, base::number_text(recording::plausible_rate(info.rate)));
    set(recording::tag_checksums, std::string(recording::checksums_kind));
    set(recording::tag_frames, recording::frames_text(0));
    if (info.calibration) {
        const std::string text = calibration::to_text(*info.calibration);
        set(recording::tag_calibration, text);
        set(recording::tag_calibration_id, calibration::calibration_identity(text));
    }
    return tags;
}

/// Matroska's clock: milliseconds since the first frame, strictly rising even where the recorded clock is not.
class ContainerClock {
public:
    explicit ContainerClock(double rate)
        : step_(rate > 0 ? std::clamp<std::int64_t>(std::llround(1000 / rate), 1, 60'000) : 40) {}

    std::int64_t stamp(std::int64_t monotonic_ns) {
        if (!last_ns_) {
            first_ns_ = monotonic_ns;
            last_ms_ = 0;
        } else if (monotonic_ns <= *last_ns_) {
            last_ms_ += step_;
        } else {
            const std::uint64_t distance =
                static_cast<std::uint64_t>(monotonic_ns) - static_cast<std::uint64_t>(first_ns_);
            const std::int64_t ms = monotonic_ns > first_ns_ ? static_cast<std::int64_t>(distance / 1'000'000) : 0;
            last_ms_ = std::max(last_ms_ + 1, std::min(ms, longest_ms));
        }
        last_ns_ = monotonic_ns;
        return last_ms_;
    }

private:
    // 34 years: a wrong clock must not overflow the container.
    static constexpr std::int64_t longest_ms = std::int64_t{1} << 40;
    std::int64_t step_;
    std::int64_t first_ns_ = 0;
    std::int64_t last_ms_ = 0;
    std::optional<std::int64_t> last_ns_;
};

}  // namespace

class RecordingWriter::Impl {
public:
    Impl(const std::string& path, const SourceInfo& info, bool overwrite)
        : path_(path),
          format_(info.format),
          eye_width_(info.eye_width),
          height_(info.height),
          jpegs_(info.jpegs.has_value()),
          clock_(recording::plausible_rate(info.rate)) {
        keep_ffmpeg_log();
        check(path, info);
        if (!jpegs_) {
            encoder_ = open_encoder(info);
            frame_ = frame_for(*encoder_);
        }
        packet_.reset(or_bad_alloc(av_packet_alloc()));
        file_.emplace(path, overwrite);
        try {
            start(info);
        } catch (...) {
            file_->discard();
            throw;
        }
    }

    ~Impl() {
        try {
            finish();
        } catch (const std::exception&) {
            // Only memory can be missing here. What the file holds by now is readable.
        }
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    void write(const RawFrame& frame) {
        if (!failure_.empty() || closed_) {
            throw std::runtime_error(closed_ ? path_ + ": is closed already" : failure_);
        }
        const RawImage& image = frame.image;
        if (image.format != format_ || image.eye_width != eye_width_ || image.height != height_) {
            throw std::invalid_argument(path_ + ": the recording began with " +
                                        size_text(format_, eye_width_, height_) + ", this frame is " +
                                        size_text(image.format, image.eye_width, image.height));
        }
        if (jpegs_ && (frame.jpeg.empty() || frame.jpeg.size() > most_jpeg_bytes)) {
            throw std::invalid_argument(path_ + ": the recording is one of JPEGs, this frame has " +
                                        std::to_string(frame.jpeg.size()) + " bytes of one, allowed 1 to " +
                                        std::to_string(most_jpeg_bytes));
        }
        const std::int64_t ms = clock_.stamp(frame.monotonic_ns);
        if (jpegs_) {
            take_jpeg(frame.jpeg);
        } else {
            encode(image, ms);
        }
        packet_->stream_index = 0;
        packet_->pts = packet_->dts = ms;
        add_facts(frame, jpegs_ ? recording::checksum(frame.jpeg) : recording::checksum(image));
        pending_bytes_ += static_cast<std::uint64_t>(packet_->size);
        const int result = av_write_frame(muxer_.get(), packet_.get());
        av_packet_unref(packet_.get());
        expect(result);
        ++frames_;
        if (pending_since_ms_ < 0) {
            pending_since_ms_ = ms;
        }
        if (pending_bytes_ >= cluster_bytes || ms - pending_since_ms_ >= cluster_ms) {
            flush();
        }
    }

    void close() {
        const bool was_well = failure_.empty();
        finish();
        if (was_well && !failure_.empty()) {
            throw std::runtime_error(failure_);
        }
    }

    std::uint64_t frames() const { return frames_; }
    std::uint64_t bytes() const { return file_->size(); }

private:
    static std::string size_text(PixelFormat format, int eye_width, int height) {
        return std::string(to_string(format)) + " " + std::to_string(eye_width) + " x " + std::to_string(height) +
               " per eye";
    }

    void start(const SourceInfo& info) {
        AVFormatContext* made = nullptr;
        if (avformat_alloc_output_context2(&made, nullptr, "matroska", nullptr) < 0) {
            throw std::runtime_error("this FFmpeg cannot write Matroska; install the distribution's libavformat");
        }
        muxer_.reset(made);
        muxer_->pb = file_->io();
        muxer_->flags |= AVFMT_FLAG_CUSTOM_IO | AVFMT_FLAG_BITEXACT;  // same frames, same file
        muxer_->flush_packets = 0;
        muxer_->metadata = tags_of(info);
        AVStream* stream = or_bad_alloc(avformat_new_stream(made, nullptr));
        if (info.jpegs) {
            stream->codecpar->codec_type = AVMEDIA_TYPE_VIDEO;
            stream->codecpar->codec_id = AV_CODEC_ID_MJPEG;
            stream->codecpar->width = info.jpegs->frame_width();
            stream->codecpar->height = info.jpegs->frame_height();
        } else if (avcodec_parameters_from_context(stream->codecpar, encoder_.get()) < 0) {
            throw std::bad_alloc();
        }
        stream->time_base = {1, 1000};
        if (const double rate = recording::plausible_rate(info.rate); rate > 0) {
            stream->avg_frame_rate = av_d2q(rate, 1'000'000);
        }
        AVDictionary* options = nullptr;
        av_dict_set(&options, "write_crc", "0", 0);  // the frame count and the size are corrected in place
        clear_ffmpeg_log();
        const int result = avformat_write_header(made, &options);
        av_dict_free(&options);
        if (result < 0) {
            throw std::runtime_error(path_ + ": cannot write: " + reason(result));
        }
        avio_flush(made->pb);
        if (file_->error() != 0) {
            throw std::runtime_error(path_ + ": cannot write: " + reason(0));
        }
        whole_size_ = file_->size();
        find_corrections();
    }

    /// Where the segment's size and the frame count lie in the file's head.
    void find_corrections() {
        std::vector<std::uint8_t> head(static_cast<std::size_t>(whole_size_));
        head.resize(file_->read(0, head));
        segment_ = find_segment(head);
        const std::string count = recording::frames_text(0);
        const std::string key = recording::tag_frames;
        const auto at_key = std::search(head.begin(), head.end(), key.begin(), key.end());
        const auto at = std::search(at_key, head.end(), count.begin(), count.end());
        if (at != head.end()) {
            count_offset_ = static_cast<std::uint64_t>(at - head.begin());
        }
    }

    void take_jpeg(std::span<const std::uint8_t> jpeg) {
        if (av_new_packet(packet_.get(), static_cast<int>(jpeg.size())) < 0) {
            throw std::bad_alloc();
        }
        std::copy(jpeg.begin(), jpeg.end(), packet_->data);
        packet_->flags |= AV_PKT_FLAG_KEY;
    }

    void encode(const RawImage& image, std::int64_t ms) {
        if (av_frame_make_writable(frame_.get()) < 0) {
            throw std::bad_alloc();
        }
        store_pixels(image, *frame_);
        frame_->pts = ms;
        clear_ffmpeg_log();
        int result = avcodec_send_frame(encoder_.get(), frame_.get());
        if (result >= 0) {
            result = avcodec_receive_packet(encoder_.get(), packet_.get());
        }
        if (result < 0) {
            throw std::runtime_error(path_ + ": cannot compress a frame: " + ffmpeg_reason(result));
        }
    }

    void add_facts(const RawFrame& frame, std::uint32_t checksum) {
        const std::size_t size =
            recording::facts_size + recording::sensors_size(frame.sensors) + recording::checksums_size;
        std::uint8_t* side =
            or_bad_alloc(av_packet_new_side_data(packet_.get(), AV_PKT_DATA_MATROSKA_BLOCKADDITIONAL, size));
        recording::put_facts({frame.sequence,
                              frame.monotonic_ns,
                              frame.realtime_ns,
                              frame.flags,
                              frame.dropped_before,
                              frame.correction,
                              {}},
                             std::span<std::uint8_t, recording::facts_size>(side, recording::facts_size));
        recording::put_sensors(frame.sensors, std::span(side, size).subspan(recording::facts_size));
        recording::put_checksums(checksum, std::span(side, size).subspan(recording::block_add_id_size));
        pending_bytes_ += size;
    }

    /// Ends the cluster: everything up to here survives the end of this process.
    void flush() {
        const int result = av_write_frame(muxer_.get(), nullptr);
        avio_flush(muxer_->pb);
        expect(result);
        whole_size_ = file_->size();
        whole_frames_ = frames_;
        pending_bytes_ = 0;
        pending_since_ms_ = -1;
    }

    std::string reason(int result) const {
        switch (file_->state()) {
            case RecordingFile::State::removed: return "the file was removed while it was written, or its folder was";
            case RecordingFile::State::cut: return "another program has cut the file while it was written";
            case RecordingFile::State::whole: break;
        }
        return file_->error() != 0 ? base::error_text(file_->error()) : ffmpeg_reason(result);
    }

    void expect(int result) {
        if (result < 0 || file_->error() != 0) {
            fail(result);
            throw std::runtime_error(failure_);
        }
    }

    /// Cuts the file after a failed write to its last whole frame, and corrects its size and frame count.
    void fail(int result) {
        const std::string why = reason(result);
        const bool repaired = keep_what_is_whole();
        failure_ = path_ + ": cannot write: " + why;
        if (frames_ > 0) {
            failure_ += "; the file keeps the first " + base::counted(frames_, "frame") +
                        (repaired ? "" : " and reads as truncated");
        }
    }

    bool keep_what_is_whole() {
        const std::uint64_t size = file_->size();
        const bool shorter = size < whole_size_;
        frames_ = shorter ? 0 : whole_frames_;
        if (!segment_ || size <= segment_->data_offset || file_->state() == RecordingFile::State::removed) {
            return false;
        }
        const MatroskaPart part = find_whole_part(
            [this](std::uint64_t offset, std::span<std::uint8_t> bytes) { return file_->read(offset, bytes); },
            shorter ? segment_->data_offset : whole_size_, size);
        frames_ += part.frames;
        if (!file_->cut(part.end)) {
            return false;
        }
        const auto& cluster = part.cluster;
        return (!cluster || note_size(cluster->offset, cluster->length, cluster->size)) &&
               note_size(segment_->size_offset, segment_->size_length, part.end - segment_->data_offset) &&
               note_count();
    }

    bool note_size(std::uint64_t offset, int length, std::uint64_t size) {
        std::array<std::uint8_t, 8> bytes{};
        const auto field = std::span(bytes).first(static_cast<std::size_t>(length));
        put_ebml_size(size, field);
        return file_->overwrite(offset, field);
    }

    bool note_count() {
        const std::string count = recording::frames_text(frames_);
        return count_offset_ != 0 &&
               file_->overwrite(count_offset_, {reinterpret_cast<const std::uint8_t*>(count.data()), count.size()});
    }

    void finish() {
        if (closed_) {
            return;
        }
        closed_ = true;
        if (failure_.empty()) {
            const int result = av_write_trailer(muxer_.get());
            avio_flush(muxer_->pb);
            if (result < 0 || file_->error() != 0 || !file_->look()) {
                fail(result);
            } else if (file_->seekable() && !note_count()) {
                failure_ = path_ + ": cannot write the number of frames";
            }
        }
        if (!file_->close() && failure_.empty()) {
            failure_ = path_ + ": cannot write: " + reason(0);
        }
    }

    std::string path_;
    PixelFormat format_;
    int eye_width_;
    int height_;
    bool jpegs_;
    ContainerClock clock_;
    CodecPtr encoder_;  ///< none for JPEGs
    FramePtr frame_;
    PacketPtr packet_;
    std::optional<RecordingFile> file_;  // outlives the muxer, which writes to it
    MuxerPtr muxer_;
    std::optional<MatroskaSegment> segment_;
    std::uint64_t count_offset_ = 0;
    std::uint64_t frames_ = 0;
    std::uint64_t whole_size_ = 0;    ///< of the file, up to the end of the last whole cluster
    std::uint64_t whole_frames_ = 0;  ///< in it
    std::uint64_t pending_bytes_ = 0;
    std::int64_t pending_since_ms_ = -1;
    bool closed_ = false;
    std::string failure_;
};

RecordingWriter::RecordingWriter(const std::string& path, const SourceInfo& info, bool overwrite)
    : impl_(std::make_unique<Impl>(path, info, overwrite)) {}

RecordingWriter::~RecordingWriter() = default;

void RecordingWriter::write(const RawFrame& frame) {
    impl_->write(frame);
}

void RecordingWriter::close() {
    impl_->close();
}

std::uint64_t RecordingWriter::frames() const {
    return impl_->frames();
}

std::uint64_t RecordingWriter::bytes() const {
    return impl_->bytes();
}

}  // namespace disparityd::capture
