//! Builds the C++ side of the engine `bullet` if the feature asks for it; else nothing.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    #[cfg(feature = "bullet")]
    bullet::build();
}

#[cfg(feature = "bullet")]
mod bullet {
    use std::path::Path;

    const ROOM: &str = "src/engine/bullet";
    const SOURCES: [&str; 6] = ["drives.cc", "motion.cc", "shapes.cc", "solver.cc", "surfaces.cc", "world.cc"];
    const HEADERS: [&str; 6] = ["drives.h", "motion.h", "shim.h", "shapes.h", "solver.h", "surfaces.h"];

    pub fn build() {
        // Debian has a float32 build beside it, `bullet`.
        let lib = match pkg_config::Config::new().cargo_metadata(false).probe("bullet-float64") {
            Ok(lib) => lib,
            Err(fault) => {
                eprintln!(
                    "the feature `bullet` needs Bullet's float64 build: apt install libbullet-dev pkg-config\n{fault}"
                );
                std::process::exit(1)
            }
        };
        let mut cc = cxx_build::bridge(format!("{ROOM}/bridge.rs"));
        cc.std("c++17").include(ROOM).files(SOURCES.map(|f| format!("{ROOM}/{f}")));
        // With /usr/include itself among these, #include_next does not find the C library's headers.
        for folder in lib.include_paths.iter().filter(|p| *p != Path::new("/usr/include")) {
            cc.flag(format!("-isystem{}", folder.display()));
        }
        for (name, value) in &lib.defines {
            cc.define(name, value.as_deref());
        }
        cc.compile("realnoid_bullet");
        for folder in &lib.link_paths {
            println!("cargo:rustc-link-search=native={}", folder.display());
        }
        // After the shim, which refers to them.
        for name in &lib.libs {
            println!("cargo:rustc-link-lib={name}");
        }
        for file in SOURCES.iter().chain(&HEADERS).chain(&["bridge.rs"]) {
            println!("cargo:rerun-if-changed={ROOM}/{file}");
        }
    }
}
