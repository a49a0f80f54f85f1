"""The causes of an arm in motion: joint by joint, beside a payload, late efforts and links that are wrong."""
