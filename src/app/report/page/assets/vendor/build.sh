#!/usr/bin/env bash
# Bundles the parts of three.js that the pages use into three.min.js, with its licence beside it. Needs node, npm and a network.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
three=0.187.0
esbuild=0.28.2
room=$(mktemp -d)
trap 'rm -rf "$room"' EXIT
cp "$here/three.entry.js" "$room/"
cd "$room"
npm init -y >/dev/null
npm install --no-fund --no-audit --silent "three@$three" "esbuild@$esbuild"
npx esbuild three.entry.js --bundle --minify --format=iife --global-name=THREE --target=es2020 --charset=ascii \
    --legal-comments=none --banner:js="/* three.js $three, MIT licence, (c) three.js authors: three.LICENSE in palpate's sources */" \
    --outfile="$here/three.min.js"
cp node_modules/three/LICENSE "$here/three.LICENSE"
