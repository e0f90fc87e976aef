/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The C interface of the client library of disparityd reads frames over shared memory or a socket.
 *
 * All calls on one object come from one thread; different objects are independent. No function throws or ends the
 * program. Functions that fail return NULL or DISPARITY_ERROR; disparity_last_error() then has one line that says why.
 */
#ifndef DISPARITY_CLIENT_H
#define DISPARITY_CLIENT_H

#include <stddef.h>
#include <stdint.h>

#include "disparity_products.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifndef DISPARITY_API
/** Marks what the library exports. */
#define DISPARITY_API __attribute__((visibility("default")))
#endif

/** Bits of disparity_frame_info.flags. */
enum {
    DISPARITY_FLAG_UNRECTIFIED = 1,      /**< no calibration: the pixels are as captured */
    DISPARITY_FLAG_INTERPOLATED = 2,     /**< rejected pixels were filled from their neighbours */
    DISPARITY_FLAG_DROPPED_BEFORE = 4,   /**< dropped_before is not 0 */
    DISPARITY_FLAG_DISCONTINUITY = 8,    /**< the first frame after a gap or restart of the source */
    DISPARITY_FLAG_SYNTHETIC = 16,       /**< rendered, or a recording of rendered frames: not from a camera */
    DISPARITY_FLAG_EXPOSURE_CENTRE = 32, /**< the capture time was moved to the centre of the exposure */
    /* Doubts: why the frame can be trusted less. */
    DISPARITY_FLAG_DARK = 0x100,         /**< both eyes see hardly any light */
    DISPARITY_FLAG_SATURATED = 0x200,    /**< much of a picture is white */
    DISPARITY_FLAG_BLURRED = 0x400,      /**< one eye sees less sharply than the other */
    DISPARITY_FLAG_DIRTY_EYE = 0x800,    /**< a part of one eye stays dull where the other eye sees texture */
    DISPARITY_FLAG_COVERED_EYE = 0x1000, /**< one eye sees nothing where the other sees texture */
    DISPARITY_FLAG_MISALIGNED = 0x2000,  /**< the rows of both eyes do not fit */
    DISPARITY_FLAG_TOO_NEAR = 0x4000,    /**< something may be nearer than can be measured */
    DISPARITY_FLAG_NOISY = 0x8000        /**< so much noise that the frame was matched for that */
};

/** The trust in a frame of these flags: 1 .. 255, more is better; 0 where the daemon does not tell it. */
#define DISPARITY_TRUST(flags) ((uint32_t)(flags) >> 24)

/** What reading returns. */
enum {
    DISPARITY_FRAME = 1,   /**< a frame newer than the one read before */
    DISPARITY_TIMEOUT = 0, /**< nothing new came in time; the daemon lives */
    DISPARITY_GONE = -1,   /**< there is no daemon; later reads look for it again. disparity_last_error() says why */
    DISPARITY_ERROR = -2   /**< the call failed, see disparity_last_error() */
};

/** A reader of the shared memory; disparity_shared_memory_open() makes it. */
typedef struct disparity_shared_memory disparity_shared_memory;
/** A connection to the daemon; disparity_socket_open() makes it. */
typedef struct disparity_socket disparity_socket;
/** A daemon, however its frames come; disparity_connect() makes it. */
typedef struct disparity_client disparity_client;
/** A frame and its planes; disparity_frame_new() makes it. */
typedef struct disparity_frame disparity_frame;

/** Everything that comes with a frame. The layout does not change within a version of the library's name; fields are
 * only added at the end, where the caller says how much room there is. */
typedef struct disparity_frame_info {
    uint64_t publish_index;  /**< counts what the daemon has published since its start, from 0, without gaps */
    uint64_t sequence;       /**< the source's own number of the frame; gaps where the source lost some */
    int64_t monotonic_ns;    /**< capture time, CLOCK_MONOTONIC of the daemon's machine */
    int64_t realtime_ns;     /**< capture time, CLOCK_REALTIME: ns since 1970 */
    int64_t age_ns;          /**< from capture until the read gave it; from another machine never less than that */
    uint64_t dropped_before; /**< frames that never were published since the one before: lost or dropped */
    uint64_t skipped;        /**< frames published but not seen by this client, since the one read before */
    uint64_t calibration_id; /**< changes when the calibration does; 0 = none */
    double f;                /**< focal length of the rectified camera, px; 0 = unknown */
    double cx;               /**< column of the principal point of the rectified camera, px */
    double cy;               /**< row of the principal point of the rectified camera, px */
    double baseline_mm;      /**< distance of the two cameras, mm; 0 = unknown */
    double disparity_offset; /**< px; is added to a valid disparity before depth is computed from it */
    int32_t d_min;           /**< the first candidate, px */
    uint32_t disparities;    /**< the number of candidates, the last one is d_min + disparities - 1 */
    int32_t invalid;         /**< the disparity of a rejected pixel, 1/16 px: (d_min - 1) * 16 */
    uint32_t flags;          /**< bits DISPARITY_FLAG_..., and DISPARITY_TRUST() */
    uint32_t width;          /**< of the whole rectified image, px */
    uint32_t height;         /**< of the whole rectified image, px */
    uint32_t region_x;       /**< the column of the whole image where the planes begin */
    uint32_t region_y;       /**< the row of the whole image where the planes begin */
    uint32_t plane_count;    /**< the number of planes that the frame carries */
    uint32_t reserved;       /**< 0 */
} disparity_frame_info;

/** One plane: rows follow each other without gaps, little endian. */
typedef struct disparity_plane {
    uint32_t product;         /**< DISPARITY_PRODUCT_... */
    uint32_t width;           /**< px */
    uint32_t height;          /**< px */
    uint32_t bytes_per_pixel; /**< all channels together */
    const void* data;         /**< owned by the frame, valid until it is read into again or freed; read-only */
    uint64_t bytes;           /**< width * height * bytes_per_pixel */
} disparity_plane;

/** Returns why the last call of this thread failed or gave DISPARITY_GONE; never NULL. Valid until the thread's next
 * call of the library. */
DISPARITY_API const char* disparity_last_error(void);

/** Makes an empty frame to read into, any number of times. Returns NULL only when memory is short. */
DISPARITY_API disparity_frame* disparity_frame_new(void);
/** Frees a frame and its planes; NULL is allowed. */
DISPARITY_API void disparity_frame_free(disparity_frame* frame);

/** Fills the first info_bytes bytes of *info; pass sizeof(disparity_frame_info). */
DISPARITY_API void disparity_frame_get_info(const disparity_frame* frame, disparity_frame_info* info,
                                            size_t info_bytes);

/** Fills *plane and returns 1, or returns 0 when the frame does not carry the product. */
DISPARITY_API int disparity_frame_get_plane(const disparity_frame* frame, uint32_t product, disparity_plane* plane);
/** Does the same by index, 0 to plane_count - 1; returns 0 when there is no plane of that index. */
DISPARITY_API int disparity_frame_plane_at(const disparity_frame* frame, uint32_t index, disparity_plane* plane);

/** Returns 1 when all that was read from the planes until now belongs to this frame: always for a copied frame, and for
 * a borrowed one until the daemon writes over it; 0 after that. NULL gives 0. */
DISPARITY_API int disparity_frame_is_whole(const disparity_frame* frame);

/** Return a number for each pixel, row by row, width * height of them: disparities in px, depths and one sigma of depth
 * in m. NaN is unknown, +infinity beyond what can be measured. Depths come from DISPARITY_PRODUCT_DEPTH, else from the
 * disparities. NULL when the frame does not carry what they are computed from, or has no calibration. They belong to
 * the frame and are valid until the same function is called again or the frame is freed. */
DISPARITY_API const float* disparity_frame_disparity_px(disparity_frame* frame, uint32_t* width, uint32_t* height);
DISPARITY_API const float* disparity_frame_depth_m(disparity_frame* frame, uint32_t* width,
                                                   uint32_t* height); /**< see above */
DISPARITY_API const float* disparity_frame_depth_error_m(disparity_frame* frame, uint32_t* width,
                                                         uint32_t* height); /**< see above */

/** A point in the axes of the rectified left camera: x right, y down, z ahead; all NaN where the depth is unknown or
 * beyond what can be measured. The layout does not change. */
typedef struct disparity_point {
    float x;        /**< m */
    float y;        /**< m */
    float z;        /**< m */
    uint8_t red;    /**< of the left image, as green and blue; all 0 where the frame carries none */
    uint8_t green;  /**< see red */
    uint8_t blue;   /**< see red */
    uint8_t unused; /**< 0 */
} disparity_point;

/** Returns the nearest point of each block of `step` columns and rows (0 counts as 1), so that nothing thin is lost:
 * row by row, width * height of them. They come from the disparities, else from DISPARITY_PRODUCT_DEPTH, their colours
 * from DISPARITY_PRODUCT_LEFT_COLOUR or DISPARITY_PRODUCT_LEFT. NULL and valid as above. */
DISPARITY_API const disparity_point* disparity_frame_points(disparity_frame* frame, uint32_t step, uint32_t* width,
                                                            uint32_t* height);

/** What a sector of an obstacle scan shows. A program takes every other value for unknown. */
enum {
    DISPARITY_SECTOR_UNKNOWN = 0,  /**< as good as nothing is known: it may hold an obstacle at any distance */
    DISPARITY_SECTOR_FREE = 1,     /**< no obstacle up to free_m; what lies beyond is unknown */
    DISPARITY_SECTOR_OCCUPIED = 2, /**< the nearest obstacle is at distance_m */
    DISPARITY_SECTOR_MASKED = 3    /**< unknown, because the robot's own parts hide all of it */
};

/** Where the ground's plane of a scan comes from. A later daemon may send other numbers: the plane holds all the same.
 */
enum {
    DISPARITY_GROUND_CONFIGURED = 0, /**< the plane z = 0 of the configured mounting */
    DISPARITY_GROUND_FITTED = 1,     /**< fitted to this frame */
    DISPARITY_GROUND_HELD = 2,       /**< fitted to an earlier frame, ground_age frames ago */
    DISPARITY_GROUND_GRAVITY = 3,    /**< level, as the camera's inertial sensor says */
    DISPARITY_GROUND_AUTOPILOT = 4   /**< level, as an autopilot says */
};

/** One sector of an obstacle scan. Distances are horizontal, from the robot's origin, in metres. An occupied sector
 * with 0 pixels has an obstacle that is nearer than can be measured: distance_m is the most that it can be, sigma_m is
 * as large. As for disparity_frame_info, fields are only added at the end. */
typedef struct disparity_scan_sector {
    float from_deg;      /**< bearing of the right edge; 0 is the robot's x axis, left is positive */
    float to_deg;        /**< bearing of the left edge */
    float distance_m;    /**< of an occupied sector: to the nearest obstacle */
    float sigma_m;       /**< one-sigma error of distance_m */
    float free_m;        /**< no obstacle is nearer than this, whatever the state; at most distance_m where occupied */
    float low_m;         /**< of the obstacle, its lowest part above the ground's plane */
    float high_m;        /**< its highest part */
    uint32_t pixels;     /**< that show the obstacle; 65535 = so many or more */
    uint32_t state;      /**< DISPARITY_SECTOR_... */
    uint32_t confidence; /**< mean of those pixels, 0 to 255 */
    uint32_t doubts;     /**< why the sector can be trusted less: bits DISPARITY_FLAG_... of doubts */
    uint32_t trust;      /**< how far it can be trusted: 1 to 255, more is better; 0: not told */
} disparity_scan_sector;

/** What is common to the sectors of an obstacle scan. The frame of reference is the robot's: x ahead, y left, z up, the
 * origin on the ground below the camera, or where the daemon's configuration puts it. Fields are only added at the end.
 */
typedef struct disparity_scan_info {
    uint32_t sectors;         /**< how many there are, by bearing, the right-most first */
    uint32_t ground;          /**< DISPARITY_GROUND_... */
    uint32_t ground_age;      /**< frames since the plane was fitted */
    float ground_height_m;    /**< the plane is z = ground_height_m + ground_slope_ahead x + ground_slope_left y */
    float ground_slope_ahead; /**< see ground_height_m */
    float ground_slope_left;  /**< see ground_height_m */
    float low_m;              /**< obstacles lie between these heights above the plane */
    float high_m;             /**< the upper one */
    float min_m;              /**< nothing nearer is reported */
    float max_m;              /**< nothing beyond is reported */
    float mounting_height_m;  /**< of the camera above the floor, as the floor in view shows; 0: not found */
    float mounting_pitch_deg; /**< likewise; positive looks down */
    float mounting_roll_deg;  /**< likewise; positive has its right side lower */
} disparity_scan_info;

/** Reads the obstacle scan of a frame. Fills the first info_bytes bytes of *info and writes up to `capacity` sectors of
 * sector_bytes bytes each; pass the sizes of the structures. info and sectors may be NULL. Returns 1, 0 when the frame
 * carries no scan, or DISPARITY_ERROR for one of another version. */
DISPARITY_API int disparity_frame_get_scan(const disparity_frame* frame, disparity_scan_info* info, size_t info_bytes,
                                           disparity_scan_sector* sectors, size_t sector_bytes, size_t capacity);

/** Maps /disparityd.NAME read-only; name NULL = "default". Returns NULL on failure. */
DISPARITY_API disparity_shared_memory* disparity_shared_memory_open(const char* name);

/** Does the same with options. owner: the user whose object is trusted, beside root's and those of this program's own
 * user, a name or a number; NULL: the user that the environment variable DISPARITYD_SHARED_MEMORY_OWNER names, else
 * "disparityd". may_be_absent not 0: succeeds without a daemon, too; reading waits for one. */
DISPARITY_API disparity_shared_memory* disparity_shared_memory_open_with(const char* name, const char* owner,
                                                                         int may_be_absent);
/** Ends the reader; its frames stay. NULL is allowed. */
DISPARITY_API void disparity_shared_memory_close(disparity_shared_memory* reader);

/** Copies the newest frame not read before, waiting at most timeout_ms. `frame` is valid only when the result is
 * DISPARITY_FRAME. Only the given products are copied; count 0 = all. Returns DISPARITY_GONE at once when the daemon
 * stops, and within 3 s when it dies. The calls after it wait for a new daemon under the name, and return
 * DISPARITY_GONE again when none has come in time: a program that keeps reading survives a restart of the daemon. */
DISPARITY_API int disparity_shared_memory_read(disparity_shared_memory* reader, disparity_frame* frame, int timeout_ms,
                                               const uint32_t* products, size_t count);

/** The same without a copy: the planes of `frame` then lie in the shared memory, and it has all that the daemon serves.
 * It gives up what it held before, whatever the result.
 * The daemon never waits: the frame stays for one frame less than the ring has slots ([shared_memory] slots), then the
 * daemon writes another one over it. So compute from the planes, then ask disparity_frame_is_whole(), and use the
 * result only if it is. The memory stays mapped until the frame is read into again or freed, even after the reader is
 * closed. */
DISPARITY_API int disparity_shared_memory_borrow(disparity_shared_memory* reader, disparity_frame* frame,
                                                 int timeout_ms);

/** Returns the nanoseconds since the daemon's last heartbeat; INT64_MAX when it is gone. */
DISPARITY_API int64_t disparity_shared_memory_heartbeat_age_ns(const disparity_shared_memory* reader);

/** Connects to "unix:PATH", "tcp:HOST:PORT" or, encrypted, "tls:HOST:PORT", and sends Hello; client_name may be NULL.
 * Returns NULL on failure. */
DISPARITY_API disparity_socket* disparity_socket_open(const char* address, const char* client_name, int timeout_ms);

/** How a client and a daemon beyond this machine know each other; memset to 0 first. NULL or "": none. The files are
 * read whenever a connection is made. Fields are only added at the end. */
typedef struct disparity_connect_options {
    const char*
        authority; /**< file (PEM): who must have signed the daemon's certificate; none: the system's authorities */
    const char* certificate; /**< file of this client's own certificate, with its chain (PEM) */
    const char* key;         /**< file of that certificate's key (PEM, not encrypted) */
    const char* server_name; /**< name or address in the daemon's certificate; none: HOST of the address */
    const char* token_file;  /**< file with the token that the daemon asks for, which not every user may read */
    const char* token;       /**< the token itself; goes before token_file */
} disparity_connect_options;

/** Does the same as disparity_socket_open() with options; pass sizeof(disparity_connect_options). Over "tls:" the
 * daemon's certificate is always checked. A token is sent over "tls:", and over "tcp:" only to this machine. The
 * strings are copied. */
DISPARITY_API disparity_socket* disparity_socket_open_with(const char* address, const char* client_name, int timeout_ms,
                                                           const disparity_connect_options* options,
                                                           size_t options_bytes);
/** Ends the connection; its frames stay. NULL is allowed. */
DISPARITY_API void disparity_socket_close(disparity_socket* client);

/** What disparity_socket_subscribe() asks for; memset to 0 first. */
typedef struct disparity_subscription {
    const uint32_t* products; /**< DISPARITY_PRODUCT_..., read during the call only */
    uint64_t product_count;   /**< the number of products; 0 = no frames */
    double max_rate;          /**< frames per second, 0 = all */
    double status_interval_s; /**< 0 = no status messages */
    uint32_t compressed;      /**< not 0: zstd */
    uint32_t region_x;        /**< column of the rectified image where the region begins */
    uint32_t region_y;        /**< row of the rectified image where the region begins */
    uint32_t region_width;    /**< px; 0 = the whole image */
    uint32_t region_height;   /**< px */
    uint32_t sensors;         /**< not 0: for disparity_socket_read_sensors() */
} disparity_subscription;

/** Replaces the subscription. Returns 0, or DISPARITY_ERROR. The next read fails when the daemon refuses. When the
 * connection has ended, the subscription holds from the next one on. */
DISPARITY_API int disparity_socket_subscribe(disparity_socket* client, const disparity_subscription* subscription);

/** Gives the newest frame that was not given before, or waits for one; a frame that has lain for more than an interval
 * is left out and counts as skipped, and a fresh one is asked for, which may take a little longer than the timeout. A
 * daemon that no longer answers, as over a link that was cut, has ended the connection, too. The first call after the
 * end of the connection returns DISPARITY_GONE. The calls after it connect again, send Hello and subscribe as before,
 * and return DISPARITY_GONE again when no daemon answers in time: a program that keeps reading survives a restart of
 * the daemon. Returns DISPARITY_ERROR when the daemon refuses; the call may be repeated. */
DISPARITY_API int disparity_socket_read(disparity_socket* client, disparity_frame* frame, int timeout_ms);

/** Bits of disparity_sensor_sample.holds; the fields of others are 0. */
enum {
    DISPARITY_SENSOR_INERTIAL = 1,        /**< angular_velocity, acceleration, imu_celsius */
    DISPARITY_SENSOR_MAGNETIC = 2,        /**< magnetic_field */
    DISPARITY_SENSOR_ENVIRONMENT = 4,     /**< celsius, hectopascal, humidity_percent */
    DISPARITY_SENSOR_EYE_TEMPERATURE = 8, /**< left_celsius, right_celsius */
    DISPARITY_SENSOR_FRAME_SYNC = 16      /**< measured at the instant of a frame's exposure */
};

/** What the camera's sensors measured at one instant, along the axes of the sensor, as the camera sends it. As for
 * disparity_frame_info, fields are only added at the end. */
typedef struct disparity_sensor_sample {
    int64_t monotonic_ns;      /**< of that instant, CLOCK_MONOTONIC of the daemon's machine */
    int64_t realtime_ns;       /**< of that instant, CLOCK_REALTIME: ns since 1970 */
    int64_t camera_ns;         /**< on the camera's clock, which starts at any value */
    uint32_t holds;            /**< bits DISPARITY_SENSOR_... */
    uint32_t lost_before;      /**< samples that the daemon lost since the one before */
    uint32_t frame_syncs;      /**< the camera's count of frames that its sensors were synchronised with */
    uint32_t skipped;          /**< samples not given to this client before this one, because it read too slowly */
    float angular_velocity[3]; /**< rad/s */
    float acceleration[3];     /**< m/s2, gravity included */
    float magnetic_field[3];   /**< microtesla */
    float imu_celsius;         /**< of the inertial sensor */
    float celsius;             /**< inside the camera */
    float hectopascal;         /**< pressure of the air */
    float humidity_percent;    /**< relative */
    float left_celsius;        /**< of the left image sensor */
    float right_celsius;       /**< of the right image sensor */
    uint32_t reserved;         /**< 0 */
} disparity_sensor_sample;

/** Waits for samples and writes them into an array of `capacity` elements of sample_bytes each; pass
 * sizeof(disparity_sensor_sample). *count: how many there are now. The next call writes those without room. The newest
 * frame that arrives meanwhile is kept for disparity_socket_read(). Returns DISPARITY_FRAME when there are samples,
 * else as disparity_socket_read(). */
DISPARITY_API int disparity_socket_read_sensors(disparity_socket* client, disparity_sensor_sample* samples,
                                                size_t sample_bytes, size_t capacity, size_t* count, int timeout_ms);

/** Asks for the status. Returns a serialized disparityd.v1.Status, owned by the client and valid until its next call of
 * this function; NULL on failure. */
DISPARITY_API const void* disparity_socket_status(disparity_socket* client, int timeout_ms, size_t* bytes);

/** Bits of disparity_inertial_calibration.holds; the fields of others are 0. */
enum {
    DISPARITY_INERTIAL_POSE = 1,       /**< rotation, translation_mm */
    DISPARITY_INERTIAL_TIME_OFFSET = 2 /**< time_offset_s */
};

/** What the daemon's calibration knows about the inertial sensor. The numbers have the names, signs and units of
 * Kalibr. Fields are only added at the end. */
typedef struct disparity_inertial_calibration {
    uint64_t calibration_id; /**< of the frames that the pose holds for: self-calibration turns the rectified camera */
    /** Row by row, takes points of the sensor's axes, which samples have, to those of the rectified left camera, which
     * disparity_point has: p_camera = rotation p_sensor + translation_mm. It is Kalibr's T_cam_imu, turned as the left
     * image was rectified. */
    double rotation[9];
    double translation_mm[3];           /**< of the sensor's origin, in the camera's axes */
    double time_offset_s;               /**< what a frame of the time t shows stands in the samples at t + this */
    double gyroscope_noise_density;     /**< white noise, rad/s/sqrt(Hz); 0 = unknown */
    double gyroscope_random_walk;       /**< of the bias, rad/s2/sqrt(Hz); 0 = unknown */
    double accelerometer_noise_density; /**< white noise, m/s2/sqrt(Hz); 0 = unknown */
    double accelerometer_random_walk;   /**< of the bias, m/s3/sqrt(Hz); 0 = unknown */
    uint32_t holds;                     /**< bits DISPARITY_INERTIAL_... */
    uint32_t reserved;                  /**< 0 */
} disparity_inertial_calibration;

/** Reads it from the bytes of disparity_socket_status() or disparity_client_status(); pass
 * sizeof(disparity_inertial_calibration). Returns 1; 0 where the calibration knows nothing of an inertial sensor;
 * DISPARITY_ERROR for bytes that are no status. Any thread. */
DISPARITY_API int disparity_inertial_calibration_of(const void* status, size_t bytes,
                                                    disparity_inertial_calibration* calibration,
                                                    size_t calibration_bytes);

/** How disparity_connect_with() connects; memset to 0 first. The strings are copied. Fields are only added at the end.
 */
typedef struct disparity_client_options {
    int32_t may_be_absent;           /**< not 0: succeeds without a daemon, too; reading waits for one */
    int32_t timeout_ms;              /**< for a socket to answer; 0 = 5000 */
    const char* client_name;         /**< of this program, in the daemon's status; NULL = "disparity-client" */
    const char* owner;               /**< as for disparity_shared_memory_open_with() */
    disparity_connect_options reach; /**< certificates and the token */
} disparity_client_options;

/** Connects to a daemon and asks for frames with these products. `where` is "default" or another name: the daemon of
 * this machine that has it, over its shared memory, else its socket; "" or NULL: the daemon of this machine, that of
 * the name "default", else the only one that runs; "unix:PATH", "/PATH", "tcp:HOST:PORT" or "tls:HOST:PORT": a socket.
 * Returns NULL where no daemon answers, or several run and none was named: disparity_last_error() names them. */
DISPARITY_API disparity_client* disparity_connect(const char* where, const uint32_t* products, size_t count);

/** Does the same with options; pass sizeof(disparity_client_options). A region comes over the socket; status_interval_s
 * is 0. */
DISPARITY_API disparity_client* disparity_connect_with(const char* where, const disparity_subscription* wanted,
                                                       const disparity_client_options* options, size_t options_bytes);
/** Ends the client; its frames stay. NULL is allowed. */
DISPARITY_API void disparity_client_close(disparity_client* client);

/** Replaces what is wanted. Returns 0, or DISPARITY_ERROR. */
DISPARITY_API int disparity_client_subscribe(disparity_client* client, const disparity_subscription* wanted);

/** Gives the newest frame that was not given before, or waits for one; up to a second longer where a daemon is being
 * connected to. The first one out of shared memory may be an old one: see its age. A restart of the daemon is survived:
 * the call that finds it gone returns DISPARITY_GONE, those after it look for it, by its name and in both ways. Returns
 * DISPARITY_ERROR when the daemon refuses; the call may be repeated. */
DISPARITY_API int disparity_client_read(disparity_client* client, disparity_frame* frame, int timeout_ms);

/** As disparity_socket_read_sensors(), also when frames come over shared memory. */
DISPARITY_API int disparity_client_read_sensors(disparity_client* client, disparity_sensor_sample* samples,
                                                size_t sample_bytes, size_t capacity, size_t* count, int timeout_ms);

/** As disparity_socket_status(), also when frames come over shared memory. */
DISPARITY_API const void* disparity_client_status(disparity_client* client, int timeout_ms, size_t* bytes);

/** Returns where frames come from now, for people: "shared memory default", "tcp:HOST:PORT"; "" without a daemon. Valid
 * until the next call of this function. */
DISPARITY_API const char* disparity_client_where(disparity_client* client);

#ifdef __cplusplus
}
#endif

#endif
