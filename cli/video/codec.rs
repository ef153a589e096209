// SPDX-License-Identifier: MIT OR Apache-2.0
//! The codecs of videos, and how ffmpeg is told of them. Knows no process.

use crate::ending::Ending;
use bhr::image::PixelFormat;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    H264,
    H265,
    Av1,
    ProRes,
    ProRes4444,
}

/// A codec with its quality.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Codec {
    kind: Kind,
    /// Smaller is better; 0 for codecs without such a scale.
    quality: u32,
    /// The pixels that it is given.
    format: PixelFormat,
}

impl Codec {
    /// The codec of a file's ending and of options, for pixels of a format; `None`: files of this ending are no videos.
    /// Errors: a codec that such files, or pixels, do not have, a quality beyond its codec's, or one for pictures.
    pub fn of(
        extension: Option<&str>,
        name: Option<&str>,
        quality: Option<u32>,
        format: PixelFormat,
    ) -> Result<Option<Self>, Ending> {
        // H.264 has 10 bits in profiles that hardly any player has.
        let name = if format.is_hdr() && extension == Some("mp4") { name.or(Some("h265")) } else { name };
        let kind = match (extension, name) {
            (Some("mp4" | "mov"), Some("h264")) | (Some("mp4"), None) => Kind::H264,
            (Some("mp4" | "mov"), Some("h265")) => Kind::H265,
            (Some("mp4"), Some("av1")) => Kind::Av1,
            (Some("mov"), Some("prores") | None) => Kind::ProRes,
            (Some("mov"), Some("prores4444")) => Kind::ProRes4444,
            (_, Some(name)) => {
                return Err(Ending::usage(format!(
                    "--codec {name}: .mp4 files are of h264, h265 or av1, .mov files of prores, prores4444, h264 or \
                     h265, and no others have one"
                )));
            }
            (_, None) => {
                return match quality {
                    Some(quality) => Err(Ending::usage(format!("--quality {quality}: it is for videos, .mp4 or .mov"))),
                    None => Ok(None),
                };
            }
        };
        let (default, best, worst) = match kind {
            // At 0 x264 makes lossless video, in a profile that few players have.
            Kind::H264 => (14, 1, 51),
            Kind::H265 => (16, 0, 51),
            Kind::Av1 => (20, 1, 63),
            Kind::ProRes | Kind::ProRes4444 => (0, 0, 0),
        };
        let quality = match quality {
            None => default,
            Some(quality) if worst == 0 => {
                return Err(Ending::usage(format!("--quality {quality}: ProRes has no such scale")));
            }
            Some(quality) if !(best..=worst).contains(&quality) => {
                return Err(Ending::usage(format!(
                    "--quality {quality}: it must lie in [{best}, {worst}], where {best} is best"
                )));
            }
            Some(quality) => quality,
        };
        if format.is_hdr() && kind == Kind::H264 {
            return Err(Ending::usage("--hdr: videos of high dynamic range are of h265, av1, prores or prores4444"));
        }
        Ok(Some(Self { kind, quality, format }))
    }

    /// Errors: sides that the codec's chroma cannot have, or transparency that it cannot hold.
    pub fn check(&self, width: u32, height: u32, transparent: bool) -> Result<(), Ending> {
        let (across, down) = match self.kind {
            Kind::H264 | Kind::H265 | Kind::Av1 => (2, 2),
            Kind::ProRes | Kind::ProRes4444 => (2, 1),
        };
        if !width.is_multiple_of(across) || !height.is_multiple_of(down) {
            return Err(Ending::usage(format!(
                "frames are {width} x {height}; in this codec their width must be a multiple of {across}, their height \
                 of {down}"
            )));
        }
        if transparent && self.kind != Kind::ProRes4444 {
            return Err(Ending::usage("--transparent: of videos only those with --codec prores4444 can be"));
        }
        Ok(())
    }

    /// ffmpeg's arguments. Encoders run on a number of threads that does not depend on the machine, where the bytes
    /// would: an encoder divides its work by that number.
    pub fn arguments(&self, transparent: bool) -> Vec<String> {
        let quality = self.quality.to_string();
        let arguments: &[&str] = match self.kind {
            Kind::H264 => &["-c:v", "libx264", "-crf", &quality, "-threads", "8"],
            Kind::H265 => &[
                "-c:v",
                "libx265",
                "-crf",
                &quality,
                "-x265-params",
                "frame-threads=3:info=0:log-level=error",
                "-tag:v",
                "hvc1",
            ],
            Kind::Av1 => &["-c:v", "libsvtav1", "-crf", &quality, "-preset", "8"],
            Kind::ProRes => &["-c:v", "prores_ks", "-profile:v", "hq", "-vendor", "apl0"],
            Kind::ProRes4444 if transparent => {
                &["-c:v", "prores_ks", "-profile:v", "4444", "-vendor", "apl0", "-alpha_bits", "16"]
            }
            Kind::ProRes4444 => &["-c:v", "prores_ks", "-profile:v", "4444", "-vendor", "apl0", "-alpha_bits", "0"],
        };
        arguments.iter().map(|argument| (*argument).to_owned()).collect()
    }

    /// The form of its pixels, by ffmpeg's names: 8 bits where players have no others, else 10.
    pub fn pixels(&self, transparent: bool) -> &'static str {
        match self.kind {
            Kind::H264 => "yuv420p",
            Kind::H265 | Kind::Av1 => "yuv420p10le",
            Kind::ProRes => "yuv422p10le",
            Kind::ProRes4444 if transparent => "yuva444p10le",
            Kind::ProRes4444 => "yuv444p10le",
        }
    }

    /// The form of the pixels that it is given, by ffmpeg's names.
    pub fn input(&self) -> &'static str {
        if self.format.is_hdr() { "x2bgr10le" } else { "rgba" }
    }

    /// The curve of its pixels, by ffmpeg's names. ProRes has no name for that of sRGB; players show both alike.
    pub fn curve(&self) -> &'static str {
        match (self.format, self.kind) {
            (PixelFormat::Rgb10A2Pq, _) => "smpte2084",
            (PixelFormat::Rgb10A2Hlg, _) => "arib-std-b67",
            (_, Kind::H264 | Kind::H265 | Kind::Av1) => "iec61966-2-1",
            (_, Kind::ProRes | Kind::ProRes4444) => "bt709",
        }
    }

    /// The primaries of its pixels, and the matrix to luma and chroma, by ffmpeg's names; and the matrix as its filter
    /// scale names it.
    pub fn primaries(&self) -> [&'static str; 3] {
        if self.format.is_hdr() { ["bt2020", "bt2020nc", "bt2020"] } else { ["bt709", "bt709", "bt709"] }
    }

    /// How the codec is made, in words that differ where its bytes do.
    pub fn name(&self) -> String {
        let Self { kind, quality, format } = self;
        if format.is_hdr() { format!("{kind:?} {quality} {format:?}") } else { format!("{kind:?} {quality}") }
    }
}
