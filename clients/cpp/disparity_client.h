/* SPDX-License-Identifier: Apache-2.0 */
/*
 * C interface of the client library of disparityd: frames over shared memory or a socket.
 *
 * All calls on one object come from one thread; different objects are independent. No function throws or ends the
 * program. Functions that fail return NULL or DISPARITY_ERROR; disparity_last_error() then has one line that says why.
 */
#ifndef DISPARITY_CLIENT_H
#define DISPARITY_CLIENT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifndef DISPARITY_API
#define DISPARITY_API __attribute__((visibility("default")))
#endif

/* Products, with the type of a pixel. */
enum {
    DISPARITY_PRODUCT_DISPARITY = 1,  /* int16_t, 1/16 px */
    DISPARITY_PRODUCT_CONFIDENCE = 2, /* uint8_t, 0 = rejected or interpolated */
    DISPARITY_PRODUCT_DEPTH = 3,      /* uint16_t, mm; 0 = unknown, 65535 = beyond 65.534 m */
    DISPARITY_PRODUCT_LEFT = 4,       /* uint8_t, rectified left image */
    DISPARITY_PRODUCT_LEFT_COLOUR = 5 /* 3 x uint8_t, BGR */
};

/* Bits of disparity_frame_info.flags. */
enum {
    DISPARITY_FLAG_UNRECTIFIED = 1,
    DISPARITY_FLAG_INTERPOLATED = 2,
    DISPARITY_FLAG_DROPPED_BEFORE = 4,
    DISPARITY_FLAG_DISCONTINUITY = 8
};

/* What reading gives. */
enum {
    DISPARITY_FRAME = 1,   /* a frame newer than the one read before */
    DISPARITY_TIMEOUT = 0, /* nothing new in time; the daemon lives */
    DISPARITY_GONE = -1,   /* the daemon has stopped or died: connect again */
    DISPARITY_ERROR = -2   /* see disparity_last_error() */
};

typedef struct disparity_shared_memory disparity_shared_memory;
typedef struct disparity_socket disparity_socket;
typedef struct disparity_frame disparity_frame;

/* Everything that comes with a frame; units as in docs/protocol.md. The layout does not change within a version of the
 * library's name; fields are only added at the end, where the caller says how much room there is. */
typedef struct disparity_frame_info {
    uint64_t publish_index;
    uint64_t sequence;
    int64_t monotonic_ns;
    int64_t realtime_ns;
    int64_t age_ns;
    uint64_t dropped_before;
    uint64_t missed;
    uint64_t calibration_id;
    double f;
    double cx;
    double cy;
    double baseline_mm;
    double disparity_offset;
    int32_t d_min;
    uint32_t disparities;
    int32_t invalid;
    uint32_t flags;
    uint32_t width;
    uint32_t height;
    uint32_t region_x;
    uint32_t region_y;
    uint32_t plane_count;
    uint32_t reserved;
} disparity_frame_info;

/* One plane: rows follow each other without gaps, little endian. */
typedef struct disparity_plane {
    uint32_t product;
    uint32_t width;
    uint32_t height;
    uint32_t bytes_per_pixel;
    const void* data; /* owned by the frame, valid until it is read into again or freed */
    uint64_t bytes;
} disparity_plane;

/* Why the last call of this thread failed; never NULL. Valid until the thread's next call of the library. */
DISPARITY_API const char* disparity_last_error(void);

/* An empty frame to read into, again and again. NULL only when memory is short. */
DISPARITY_API disparity_frame* disparity_frame_new(void);
DISPARITY_API void disparity_frame_free(disparity_frame* frame);

/* Fills the first info_bytes bytes of *info; pass sizeof(disparity_frame_info). */
DISPARITY_API void disparity_frame_get_info(const disparity_frame* frame, disparity_frame_info* info,
                                            size_t info_bytes);

/* 1 and fills *plane, or 0 when the frame does not carry the product / has no plane of that index. */
DISPARITY_API int disparity_frame_get_plane(const disparity_frame* frame, uint32_t product, disparity_plane* plane);
DISPARITY_API int disparity_frame_plane_at(const disparity_frame* frame, uint32_t index, disparity_plane* plane);

/* Maps /disparityd.<name> read-only; name NULL = "default". NULL on failure. */
DISPARITY_API disparity_shared_memory* disparity_shared_memory_open(const char* name);
DISPARITY_API void disparity_shared_memory_close(disparity_shared_memory* reader);

/* Copies the newest frame not read before, waiting at most timeout_ms. Only the given products are copied; count 0 =
 * all. After DISPARITY_GONE the next call looks for a new daemon under the same name. */
DISPARITY_API int disparity_shared_memory_read(disparity_shared_memory* reader, disparity_frame* frame, int timeout_ms,
                                               const uint32_t* products, size_t count);

/* Nanoseconds since the daemon's last sign of life; INT64_MAX when it is gone. */
DISPARITY_API int64_t disparity_shared_memory_heartbeat_age_ns(const disparity_shared_memory* reader);

/* Connects to "tcp:HOST:PORT" or "unix:PATH" and says hello; client_name may be NULL. NULL on failure. */
DISPARITY_API disparity_socket* disparity_socket_open(const char* address, const char* client_name, int timeout_ms);
DISPARITY_API void disparity_socket_close(disparity_socket* client);

/* What disparity_socket_subscribe() asks for; memset to 0 first. */
typedef struct disparity_subscription {
    const uint32_t* products;
    uint64_t product_count;
    double max_rate;          /* frames per second, 0 = all */
    double status_interval_s; /* 0 = no status messages */
    uint32_t compressed;      /* not 0: zstd */
    uint32_t region_x;
    uint32_t region_y;
    uint32_t region_width; /* 0 = the whole image */
    uint32_t region_height;
    uint32_t sensors; /* not 0: for disparity_socket_read_sensors() */
} disparity_subscription;

/* 0, or DISPARITY_ERROR. A refusal of the daemon comes out of the next read. */
DISPARITY_API int disparity_socket_subscribe(disparity_socket* client, const disparity_subscription* subscription);

/* Waits for the next frame. */
DISPARITY_API int disparity_socket_read(disparity_socket* client, disparity_frame* frame, int timeout_ms);

/* Bits of disparity_sensor_sample.holds; the fields of others are 0. */
enum {
    DISPARITY_SENSOR_INERTIAL = 1,        /* angular_velocity, acceleration, imu_celsius */
    DISPARITY_SENSOR_MAGNETIC = 2,        /* magnetic_field */
    DISPARITY_SENSOR_ENVIRONMENT = 4,     /* celsius, hectopascal, humidity_percent */
    DISPARITY_SENSOR_EYE_TEMPERATURE = 8, /* left_celsius, right_celsius */
    DISPARITY_SENSOR_FRAME_SYNC = 16      /* measured at the instant of a frame's exposure */
};

/* What the camera's sensors measured at one instant, along the axes of the sensor, as the camera sends it. As for
 * disparity_frame_info, fields are only added at the end. */
typedef struct disparity_sensor_sample {
    int64_t monotonic_ns;
    int64_t realtime_ns;
    int64_t camera_ns; /* the camera's clock, which starts anywhere */
    uint32_t holds;
    uint32_t lost_before;      /* samples that the daemon lost since the one before */
    uint32_t frame_syncs;      /* the camera's count of frames that its sensors were synchronised with */
    uint32_t skipped;          /* samples that this client missed before this one, because it read too slowly */
    float angular_velocity[3]; /* rad/s */
    float acceleration[3];     /* m/s2, gravity included */
    float magnetic_field[3];   /* microtesla */
    float imu_celsius;
    float celsius; /* inside the camera */
    float hectopascal;
    float humidity_percent;
    float left_celsius; /* of the left image sensor */
    float right_celsius;
    uint32_t reserved;
} disparity_sensor_sample;

/* Waits for samples and writes them into an array of `capacity` elements of sample_bytes each; pass
 * sizeof(disparity_sensor_sample). *count: how many there are now. What finds no room comes with the next call. Frames
 * that arrive meanwhile are kept for disparity_socket_read(), 8 of them. DISPARITY_FRAME: there are samples. */
DISPARITY_API int disparity_socket_read_sensors(disparity_socket* client, disparity_sensor_sample* samples,
                                                size_t sample_bytes, size_t capacity, size_t* count, int timeout_ms);

/* Asks for the status: a serialized disparityd.v1.Status, owned by the client and valid until its next call of this
 * function. NULL on failure. */
DISPARITY_API const void* disparity_socket_status(disparity_socket* client, int timeout_ms, size_t* bytes);

#ifdef __cplusplus
}
#endif

#endif
