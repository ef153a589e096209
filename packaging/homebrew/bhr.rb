# SPDX-License-Identifier: MIT OR Apache-2.0
# A Homebrew formula, which builds the crate that cargo packs from this repository. Checked by
#
#     cargo package --no-verify && brew install --build-from-source ./packaging/homebrew/bhr.rb && brew test bhr
#
# Homebrew was never run on it: it is for macOS, and only its syntax was checked (ruby -c).
class Bhr < Formula
  desc "Embeddable black-hole renderer with a C API"
  version "0.2.0"
  url "file://#{File.expand_path("../../target/package/libbhr-#{version}.crate", __dir__)}", using: :nounzip
  license any_of: ["MIT", "Apache-2.0"]

  depends_on "rust" => :build
  depends_on "pkgconf" => :test

  def install
    system "tar", "--strip-components=1", "-xzf", Dir["*.crate"].first
    system "./install", "--prefix=#{prefix}"
  end

  test do
    (testpath/"version.c").write <<~C
      #include <bhr.h>
      #include <stdio.h>
      int main(void) { return puts(bhr_version_string()) < 0; }
    C
    flags = shell_output("pkgconf --cflags --libs bhr").split
    system ENV.cc, "version.c", "-o", "version", *flags, "-Wl,-rpath,#{lib}"
    assert_match version.to_s, shell_output("./version")
  end
end
