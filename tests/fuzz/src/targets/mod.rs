//! One file a target. Each target takes any bytes, never panics, and takes little time and memory for a small input.

pub mod bvh;
pub mod clips;
pub mod document;
pub mod export;
pub mod fit;
pub mod image_bmp;
pub mod image_exr;
pub mod image_jpeg;
pub mod image_png;
pub mod image_tiff;
pub mod image_webp;
pub mod openfx;
pub mod reshape;
pub mod session;
pub mod silhouette;
pub mod style;
pub mod svg;
pub mod tween;

/// A target.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Its name: that of its file, of its binary and of its folder of seeds.
    pub name: &'static str,
    /// What it does with an input.
    pub run: fn(&[u8]),
}

/// All targets.
pub const ALL: [Target; 18] = [
    Target { name: "bvh", run: bvh::bvh },
    Target { name: "clips", run: clips::clips },
    Target { name: "document", run: document::document },
    Target { name: "export", run: export::export },
    Target { name: "fit", run: fit::fit },
    Target { name: "image_bmp", run: image_bmp::image_bmp },
    Target { name: "image_exr", run: image_exr::image_exr },
    Target { name: "image_jpeg", run: image_jpeg::image_jpeg },
    Target { name: "image_png", run: image_png::image_png },
    Target { name: "image_tiff", run: image_tiff::image_tiff },
    Target { name: "image_webp", run: image_webp::image_webp },
    Target { name: "openfx", run: openfx::openfx },
    Target { name: "reshape", run: reshape::reshape },
    Target { name: "session", run: session::session },
    Target { name: "silhouette", run: silhouette::silhouette },
    Target { name: "style", run: style::style },
    Target { name: "svg", run: svg::svg },
    Target { name: "tween", run: tween::tween },
];

/// The target of a name.
pub fn find(name: &str) -> Option<Target> {
    ALL.into_iter().find(|target| target.name == name)
}
