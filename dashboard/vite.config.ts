/// <reference types="vitest/config" />
import { defineConfig } from "vite";

// A rack to work against during `npm run dev`: `stator run RACK --http 8080`.
const rack = "http://127.0.0.1:8080";

export default defineConfig({
  base: "/",
  json: { namedExports: false, stringify: true }, // languages
  esbuild: { jsx: "automatic", jsxImportSource: "preact" },
  build: {
    target: "es2022",
    outDir: "dist",
    emptyOutDir: true,
    // The server's Content-Security-Policy allows nothing inline, data: addresses included.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    reportCompressedSize: false,
    chunkSizeWarningLimit: 600, // kB: three.js, which is fetched when a machine is first shown
  },
  server: {
    // The server refuses pages of other origins, so requests are passed on without one.
    proxy: {
      "/openapi.json": rack,
      "/api": {
        target: rack,
        changeOrigin: true,
        ws: true,
        configure: (proxy) => {
          const strip = (request: { removeHeader(name: string): void }) => {
            request.removeHeader("origin");
            request.removeHeader("sec-fetch-site");
          };
          proxy.on("proxyReq", strip);
          proxy.on("proxyReqWs", strip);
        },
      },
    },
  },
  test: {
    include: ["tests/**/*.test.{ts,mjs}", "src/**/*.test.ts"],
    environment: "node",
  },
});
